"""Put links into a graph and take others out, and let the poses follow: as a whole or not at all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

from slam.graph.graph import Pair, PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.problem import choose_root, reachable
from slam.graph.shift import Snapshot
from slam.graph.verify import join
from slam.params import Params
from slam.types import Link


@contextmanager
def exchanged(
    graph: PoseGraph,
    remove: Sequence[Pair],
    add: Sequence[Link],
    params: Params,
    there: Snapshot | None = None,
    *,
    keep: bool = True,
) -> Iterator[int]:
    """The graph with other links and its poses optimised; if the block raises, it is as it was.

    Args:
        graph: changed in place.
        remove: both ids of each link to take out.
        add: links to put in; graphs that meet in one of them are first brought together rigidly.
        params: for the optimisation.
        there: the poses of the graph afterwards where they are known; None optimises.
        keep: False puts everything back when the block ends.

    Yields:
        The number of nodes that lose their way to the oldest node of their graph: they keep their poses.

    Raises:
        OptimizationError: a link to remove is not there, one to add does not fit, or there is no solution.
    """
    poses, removed, added, kept = graph.poses, list[Link](), list[Link](), False
    graph.poses = dict(poses)
    try:
        for pair in remove:
            removed.append(graph.remove_link(pair))
        for link in add:
            join(graph, link)
            added.append(link)
        _settle(graph, [link.pair for link in (*removed, *added)], params, there)
        yield _separated(graph, [link.pair for link in removed])
        kept = keep
    finally:
        if not kept:
            _put_back(graph, removed, added)
            graph.poses = poses


def _put_back(graph: PoseGraph, removed: Sequence[Link], added: Sequence[Link]) -> None:
    for link in reversed(added):
        graph.remove_link(link.pair)
    for link in reversed(removed):
        graph.add_link(link)


def _settle(graph: PoseGraph, pairs: Sequence[Pair], params: Params, there: Snapshot | None) -> None:
    if there is not None:
        graph.poses = there.poses()
        return
    for root in _roots(graph, pairs, params):
        graph.poses = optimize(graph, params, root=root).poses


def _roots(graph: PoseGraph, pairs: Iterable[Pair], params: Params) -> list[int]:
    """The node held fixed for each pair; of a pair that came apart, that of the older part: the other stays."""
    root_of: dict[int, int] = {}
    for node_id in (i for pair in pairs for i in pair):
        if node_id not in root_of:
            root = choose_root(graph, params, node_id)
            root_of |= dict.fromkeys(reachable(graph, node_id, params), root)
    return sorted({min(root_of[i] for i in pair) for pair in pairs})


def _separated(graph: PoseGraph, pairs: Iterable[Pair]) -> int:
    lost: set[int] = set()
    for pair in pairs:
        sides = [graph.component(node_id) for node_id in pair]
        if pair[1] not in sides[0]:
            lost |= max(sides, key=min)
    return len(lost)
