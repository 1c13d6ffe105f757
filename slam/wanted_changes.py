"""What entries of the journal ask of a graph: links, nodes, and poses with both as they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slam.database.records import JournalEntry
from slam.graph.exchange import GraphNode
from slam.types import Link, LinkType, Placement

#: Of many decisions that are made together so many are named.
_NAMED = 5


def links_of(entries: Sequence[JournalEntry]) -> tuple[list[Link], list[Link]]:
    """Links that these entries put into the graph, and those that they take out."""
    changes = [e for e in entries if _is_prior(e) or not _same(e.link_before, e.link_after)]
    return [e.link_after for e in changes if e.link_after], [e.link_before for e in changes if e.link_before]


def nodes_of(entries: Sequence[JournalEntry]) -> tuple[list[GraphNode], list[int]]:
    """Nodes that these entries put into the graph, and ids of those that they take out."""
    changes = [entry.node for entry in entries if entry.node is not None]
    restore = [
        GraphNode(n.node_id, n.map_id, n.T_odom_base, n.T_map_base, n.constraints) for n in changes if n.restores
    ]
    return restore, [n.node_id for n in changes if n.drops]


def placement_of(entries: Sequence[JournalEntry]) -> Placement | None:
    """What these entries do to all poses; such a decision is made alone."""
    return next((entry.placement for entry in entries if entry.placement is not None), None)


def named(entries: Sequence[JournalEntry]) -> str:
    """What they are about, in a few words."""
    if placement_of(entries) is not None:
        return "the map"
    named = [f"{e.from_id}->{e.to_id}" if e.from_id != e.to_id else f"node {e.from_id}" for e in entries[:_NAMED]]
    return ", ".join([*named, f"and {len(entries) - _NAMED} more"] if len(entries) > _NAMED else named)


def joins(link: Link) -> bool:
    """Whether a link is one of two nodes, and no prior or sighting of a landmark."""
    return link.to_id > 0 and link.from_id != link.to_id


def _is_prior(entry: JournalEntry) -> bool:
    """A prior that is given again as it was is one that parameters have let in: the poses must follow."""
    return any(k is not None and k.type is LinkType.POSE_PRIOR for k in (entry.link_before, entry.link_after))


def _same(a: Link | None, b: Link | None) -> bool:
    if a is None or b is None or a.T_from_to is None or b.T_from_to is None:
        return a is b
    return (
        a.type is b.type and np.array_equal(a.T_from_to, b.T_from_to) and np.array_equal(a.information, b.information)
    )
