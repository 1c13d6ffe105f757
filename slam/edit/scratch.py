"""A copy of a graph to try things on."""

from __future__ import annotations

from slam.graph.graph import PoseGraph


def scratch(graph: PoseGraph) -> PoseGraph:
    """The same nodes, links, constraints and poses; changing it leaves the original alone."""
    copy = PoseGraph()
    for node_id, T_map_base in graph.poses.items():
        copy.add_node(node_id, graph.map_ids[node_id], graph.T_odom[node_id], T_map_base)
    for link in graph.links.values():
        copy.add_link(link)
    for link in graph.constraints.values():
        copy.add_constraint(link)
    return copy
