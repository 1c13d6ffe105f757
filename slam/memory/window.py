"""The surroundings of some nodes in the whole graph, in RAM or not, held all around by what lies beyond."""

from __future__ import annotations

from collections.abc import Iterable

from slam.graph.graph import PoseGraph
from slam.types import Link, LinkType


def window(whole: PoseGraph, active: PoseGraph, node_ids: Iterable[int], size: int) -> PoseGraph:
    """A graph of the nodes next to some, counted in links, all with their real links; those at its rim are held.

    Args:
        whole: all nodes, with poses that are up to date.
        active: nodes in RAM; what isn't linked there isn't linked here, what was linked a moment ago is.
        node_ids: in the middle, in RAM.
        size: nodes that may move.
    """
    free = dict.fromkeys(node_ids)
    for node_id in (queue := list(free)):
        beside = [i for i in _links(whole, active, node_id) if i not in free][: size - len(free)]
        free |= dict.fromkeys(beside)
        queue += beside
    part = PoseGraph()
    links = {link.pair: link for node_id in free for link in _links(whole, active, node_id).values()}
    part.held = {i for pair in links for i in pair if i not in free}
    for node_id in sorted(free.keys() | part.held):
        part.add_node(node_id, whole.map_ids[node_id], whole.T_odom[node_id], whole.poses[node_id])
    for pair in sorted(links):
        part.add_link(links[pair])
    part.between = whole.between & part.poses.keys()
    for (node_id, _, kind), link in whole.constraints.items():
        if node_id in free or (node_id in part.held and kind is LinkType.LANDMARK):
            part.add_constraint(link)
    return part


def _links(whole: PoseGraph, active: PoseGraph, node_id: int) -> dict[int, Link]:
    """Real links of a node by the other end, but those that were taken out of the graph of RAM."""
    return {
        other: link
        for other, link in whole.neighbors(node_id).items()
        if link.pair in active.links or not active.has(*link.pair)
    }
