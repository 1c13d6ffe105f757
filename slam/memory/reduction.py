"""Two nodes of one place become one: the older stays (``Mem/ReduceGraph``), or the newer (rehearsal)."""

from __future__ import annotations

from dataclasses import replace

from slam.database import Reduction
from slam.geometry import between
from slam.graph.composition import composed
from slam.graph.graph import PoseGraph
from slam.memory.memory import Memory
from slam.types import Link, LinkType


def reduction(node_id: int, memory: Memory, graph: PoseGraph) -> Reduction | None:
    """How a node that leaves short-term memory becomes part of an older one; None when no loop ties it to one in RAM.

    Its neighbours are linked with the older node instead, and so is what other loops tie it to, each over the loop: the
    covariances of both links add up. Where it is tied to several older nodes the oldest takes it in.

    Args:
        node_id: the node; with a label or an intermediate one it must not be asked for.
        memory: the tiers.
        graph: nodes in RAM with their links.
    """
    links = graph.neighbors(node_id)
    older = [i for i, link in links.items() if link.type.is_loop and i < node_id and _is_place(i, memory)]
    if not older:
        return None
    return _merged(node_id, min(older), graph)


def replacement(node_id: int, by: int, graph: PoseGraph) -> Reduction:
    """How the last node becomes part of a new one that looks like it (``Mem/RehearsalIdUpdatedToNewOne``)."""
    return replace(_merged(node_id, by, graph, LinkType.NEIGHBOR), marked=True)


def _merged(node_id: int, into: int, graph: PoseGraph, step: LinkType = LinkType.NEIGHBOR_MERGED) -> Reduction:
    links = graph.neighbors(node_id)
    joint = links[into]
    moved = (_over(joint, link, into, node_id, other, step) for other, link in sorted(links.items()) if other != into)
    return Reduction(
        node_id=node_id,
        into=into,
        T_into_node=between(graph.poses[into], graph.poses[node_id]),
        links=tuple(link for link in moved if link.pair not in graph.links),
    )


def _is_place(node_id: int, memory: Memory) -> bool:
    return node_id in memory.nodes and memory.weights[node_id] >= 0


def _over(joint: Link, link: Link, into: int, middle: int, other: int, step: LinkType) -> Link:
    """The link of another node with the one that takes the middle one in, from the newer to the older."""
    kind = step if link.type is LinkType.NEIGHBOR else link.type
    if other > into:
        return composed(link, joint, other, middle, into, kind)
    return composed(joint, link, into, middle, other, kind)
