"""Put links and nodes into a graph and take others out, and let the poses follow: as a whole or not at all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from slam.errors import OptimizationError
from slam.geometry import Pose
from slam.graph.components import components
from slam.graph.graph import Pair, PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.problem import choose_root, reachable
from slam.graph.shift import Snapshot
from slam.graph.verify import join
from slam.params import Params
from slam.types import Link


@dataclass(frozen=True, slots=True, eq=False)
class GraphNode:
    """A node that comes (back) into a graph: poses (4, 4), and what joins it with no other node."""

    node_id: int
    map_id: int
    T_odom_base: Pose
    T_map_base: Pose
    constraints: tuple[Link, ...] = ()


@contextmanager
def exchanged(
    graph: PoseGraph,
    remove: Sequence[Pair],
    add: Sequence[Link],
    params: Params,
    there: Snapshot | None = None,
    *,
    keep: bool = True,
    drop: Sequence[int] = (),
    restore: Sequence[GraphNode] = (),
    release: Sequence[Link] = (),
    hold: Sequence[Link] = (),
) -> Iterator[int]:
    """The graph with other links and nodes and its poses optimised; if the block raises, it is as it was.

    Args:
        graph: changed in place.
        remove: both ids of each link to take out.
        add: links to put in; graphs that meet in one of them are first brought together rigidly.
        params: for the optimisation.
        there: the poses of the graph afterwards where they are known; None optimises.
        keep: False puts everything back when the block ends.
        drop: ids of nodes to take out; ``remove`` names all their links.
        restore: nodes to put in.
        release: priors and sightings of landmarks to take out.
        hold: those to put in.

    Yields:
        The number of nodes that lose their way to the oldest node of their graph: they keep their poses.

    Raises:
        OptimizationError: a link to remove is not there, one to add does not fit, or there is no solution.
    """
    poses, removed, added, kept = graph.poses, list[Link](), list[Link](), False
    dropped, restored = list[GraphNode](), list[int]()
    released, held = list[Link](), list[Link]()
    graph.poses = dict(poses)
    try:
        for pair in remove:
            removed.append(graph.remove_link(pair))
        for node in restore:
            _add_node(graph, node)
            restored.append(node.node_id)
        for node_id in drop:
            dropped.append(_take_out(graph, node_id))
        for link in add:
            join(graph, link)
            added.append(link)
        for link in release:
            graph.remove_constraint(link)
            released.append(link)
        for link in hold:
            graph.add_constraint(link)
            held.append(link)
        changed = [link.pair for link in (*removed, *added)]
        changed += [(link.from_id, link.from_id) for link in (*released, *held)]
        _settle(graph, changed, params, there)
        yield _separated(graph, [link.pair for link in removed])
        kept = keep
    finally:
        if not kept:
            for link in reversed(held):
                graph.remove_constraint(link)
            for link in reversed(released):
                graph.add_constraint(link)
            for link in reversed(added):
                graph.remove_link(link.pair)
            for node in reversed(dropped):
                _add_node(graph, node)
            for node_id in reversed(restored):
                graph.remove_node(node_id)
            for link in reversed(removed):
                graph.add_link(link)
            graph.poses = poses


def _add_node(graph: PoseGraph, node: GraphNode) -> None:
    graph.add_node(node.node_id, node.map_id, node.T_odom_base, node.T_map_base)
    for link in node.constraints:
        graph.add_constraint(link)


def _take_out(graph: PoseGraph, node_id: int) -> GraphNode:
    """Remove a node whose links are gone; what puts it back."""
    if graph.neighbors(node_id):
        raise OptimizationError(f"node {node_id} can't be taken out: it still has links")
    alone = tuple(link for key, link in sorted(graph.constraints.items()) if key[0] == node_id)
    node = GraphNode(node_id, graph.map_ids[node_id], graph.T_odom[node_id], graph.poses[node_id], alone)
    graph.remove_node(node_id)
    return node


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
        if node_id not in root_of and node_id in graph:
            root = choose_root(graph, params, node_id)
            root_of |= dict.fromkeys(reachable(graph, node_id, params), root)
    ends = ([root_of[i] for i in pair if i in root_of] for pair in pairs)
    return sorted({min(roots) for roots in ends if roots})


def _separated(graph: PoseGraph, pairs: Iterable[Pair]) -> int:
    gone, lost = list(pairs), set[int]()
    joined = components({i for pair in gone for i in pair}, gone)
    for first in sorted(set(joined.values())):
        # What the links that went had joined, over nodes that went with them too.
        ends = [i for i, root in joined.items() if root == first and i in graph]
        sides = sorted((graph.component(i) for i in ends), key=min)
        lost |= {i for side in sides for i in side if i not in sides[0]}
    return len(lost)
