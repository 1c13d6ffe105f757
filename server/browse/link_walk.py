"""From one link to the next of its class, along the path."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

from server.browse.snapshot import Pair, Snapshot
from server.schemas import LinkWalk
from slam.types import LinkType

_ODOMETRY = (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED)


def link_walk(snapshot: Snapshot, pair: Pair, kind: LinkType) -> LinkWalk:
    """The links before and after one (smaller id first) among odometry's links, or else among the loops of the graph.

    A loop that is not in the graph is walked from where it would be.
    """
    loops = kind not in _ODOMETRY
    own, others = (_pairs(snapshot, loops=wanted) for wanted in (loops, not loops))
    at = bisect_left(own, _along(pair), key=_along)
    here = at < len(own) and own[at] == pair
    after = at + 1 if here else at
    return LinkWalk(
        loops=loops,
        index=at + 1 if here else None,
        total=len(own),
        previous=list(own[at - 1]) if at > 0 else None,
        next=list(own[after]) if after < len(own) else None,
        other=_nearest(others, pair),
    )


def _pairs(snapshot: Snapshot, *, loops: bool) -> list[Pair]:
    """Loops of the graph, or odometry's links, along the path."""
    links = snapshot.links.items()
    found = [pair for pair, link in links if (link.type.is_loop if loops else link.type in _ODOMETRY)]
    return sorted(found, key=_along)


def _nearest(pairs: Sequence[Pair], pair: Pair) -> list[int] | None:
    """The first that ends at the same node or after; the last where all end before."""
    if not pairs:
        return None
    return list(pairs[min(bisect_left(pairs, (pair[1], 0), key=_along), len(pairs) - 1)])


def _along(pair: Pair) -> Pair:
    """Newer node first: the order in which links came."""
    return pair[1], pair[0]
