"""The pose graph: every node of a map, the links between them, and where the optimiser put them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Protocol, Self

import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Pose, inverse
from slam.types import WEIGHT_INTERMEDIATE, WEIGHT_INVALID, Link, LinkType

Pair = tuple[int, int]
#: Constraints of single nodes, by the link's ends and type: a node may have a prior and gravity.
ConstraintKey = tuple[int, int, LinkType]
#: Cost of walking along a link (0 or 1 steps); None when it isn't followed.
Follow = Callable[[Link], int | None]


class NodeColumns(Protocol):
    """The columns of a map file's nodes that a graph needs; row i of each is the same node."""

    @property
    def ids(self) -> Iterable[int]:
        """(N,) ids."""
        ...

    @property
    def map_ids(self) -> Iterable[int]:
        """(N,) session numbers."""
        ...

    @property
    def weights(self) -> Iterable[int]:
        """(N,) weights."""
        ...

    @property
    def T_odom(self) -> Iterable[Pose]:
        """(N, 4, 4) odometry poses, NaN where unknown."""
        ...


class GraphReader(Protocol):
    """What ``PoseGraph.from_reader`` asks of a map file."""

    def nodes(self) -> NodeColumns:
        """All nodes."""
        ...

    def links(self) -> Iterable[Link]:
        """All links, each pair once."""
        ...

    def poses(self) -> Mapping[int, Pose]:
        """Id -> optimised pose ``T_map_base``."""
        ...


def one_step(link: Link) -> int | None:
    """The plain ``Follow``: each link is one step."""
    del link
    return 1


class PoseGraph:
    """Poses and links of all nodes of a map; light enough to hold a whole one (no images, no features).

    Attributes:
        T_odom: id -> (4, 4) odometry pose ``T_odom_base``.
        map_ids: id -> session number.
        links: pair of ids, smaller first -> link.
        constraints: priors, gravity and sightings of landmarks, which join no two nodes.
        poses: id -> (4, 4) optimised pose ``T_map_base``.
        between: intermediate nodes, which count as no step on any way.
        held: nodes that an optimisation leaves where they are.
        solver_state: what an incremental optimiser keeps from one call to the next.
    """

    def __init__(self) -> None:
        self.T_odom: dict[int, Pose] = {}
        self.map_ids: dict[int, int] = {}
        self.links: dict[Pair, Link] = {}
        self.constraints: dict[ConstraintKey, Link] = {}
        self.poses: dict[int, Pose] = {}
        self.between: set[int] = set()
        self.held: set[int] = set()
        self.solver_state: object | None = None
        self._adjacent: dict[int, dict[int, Link]] = {}

    def __len__(self) -> int:
        return len(self._adjacent)

    def __contains__(self, node_id: object) -> bool:
        return node_id in self._adjacent

    def copy(self) -> Self:
        """A graph of its own with the same nodes, links and poses; what an optimiser keeps stays here."""
        other = type(self)()
        other.T_odom, other.map_ids, other.poses = dict(self.T_odom), dict(self.map_ids), dict(self.poses)
        other.links, other.constraints = dict(self.links), dict(self.constraints)
        other._adjacent = {node_id: dict(links) for node_id, links in self._adjacent.items()}
        return other

    def has(self, *node_ids: int) -> bool:
        """Whether all these nodes are in the graph."""
        return all(i in self._adjacent for i in node_ids)

    def add_node(self, node_id: int, map_id: int, T_odom_base: Pose, T_map_base: Pose) -> None:
        """Take in a node that has no links yet; raises OptimizationError when the id is there already."""
        if node_id in self._adjacent:
            raise OptimizationError(f"node {node_id} is in the graph already; ids must be unique")
        self.T_odom[node_id] = T_odom_base
        self.map_ids[node_id] = map_id
        self.poses[node_id] = T_map_base
        self._adjacent[node_id] = {}

    def remove_node(self, node_id: int) -> None:
        """Take out a node and all its links; raises OptimizationError when there is none of this id."""
        for pair in [link.pair for link in self.neighbors(node_id).values()]:
            self.remove_link(pair)
        for key in [key for key in self.constraints if key[0] == node_id]:
            del self.constraints[key]
        self.between.discard(node_id)
        del self.T_odom[node_id], self.map_ids[node_id], self.poses[node_id], self._adjacent[node_id]

    def add_link(self, link: Link) -> None:
        """Join two nodes of the graph.

        Raises:
            OptimizationError: a node is missing, the pair is linked already, or the link has no transform.
        """
        missing = [i for i in link.pair if i not in self._adjacent]
        if missing:
            raise OptimizationError(f"link {name(link)}: node {missing[0]} is not in the graph")
        if link.from_id == link.to_id or link.T_from_to is None:
            raise OptimizationError(f"link {name(link)} joins no two poses: it needs two nodes and a transform")
        if link.pair in self.links:
            raise OptimizationError(f"link {name(link)}: the pair is joined by a {self.links[link.pair].type.label}")
        self.links[link.pair] = link
        self._adjacent[link.from_id][link.to_id] = link
        self._adjacent[link.to_id][link.from_id] = link

    def add_constraint(self, link: Link) -> None:
        """Take in a prior or gravity of a node, or its sighting of a landmark; replaces the one it had.

        Raises:
            OptimizationError: the node is missing, or the link is none of these.
        """
        if not _is_constraint(link):
            raise OptimizationError(f"link {name(link)} is no prior, gravity or sighting of a landmark")
        if link.from_id not in self._adjacent:
            raise OptimizationError(f"link {name(link)}: node {link.from_id} is not in the graph")
        self.constraints[link.from_id, link.to_id, link.type] = link

    def remove_constraint(self, link: Link) -> None:
        """Take out a prior, gravity or sighting, by its ends and type; raises OptimizationError without one."""
        if self.constraints.pop((link.from_id, link.to_id, link.type), None) is None:
            raise OptimizationError(f"link {name(link)} is not in the graph")

    def remove_link(self, pair: Pair) -> Link:
        """Take out and return the link of a pair of ids in any order; raises OptimizationError without one."""
        link = self.links.pop((min(pair), max(pair)), None)
        if link is None:
            raise OptimizationError(f"nodes {pair[0]} and {pair[1]} are not linked")
        del self._adjacent[link.from_id][link.to_id]
        del self._adjacent[link.to_id][link.from_id]
        return link

    def neighbors(self, node_id: int) -> Mapping[int, Link]:
        """Linked id -> link, read-only; raises OptimizationError when the node isn't in the graph."""
        found = self._adjacent.get(node_id)
        if found is None:
            raise OptimizationError(f"node {node_id} is not in the graph")
        return MappingProxyType(found)

    def within(self, node_id: int, depth: int, follow: Follow = one_step) -> dict[int, int]:
        """Ids at most ``depth`` steps away -> their distance in steps, the nearest first (0-1 breadth-first search).

        Stepping on an intermediate node costs nothing. ``follow`` says what a link costs: the Bayes filter walks global
        closures for nothing and proximity links not at all, proximity detection counts every link.
        """
        self.neighbors(node_id)
        found: dict[int, int] = {}
        queue = deque([(node_id, 0)])
        while queue:
            at, distance = queue.popleft()
            if at in found:
                continue
            found[at] = distance
            for other, link in self._adjacent[at].items():
                cost = None if other in found else follow(link)
                if cost == 0 or (cost is not None and other in self.between):
                    queue.appendleft((other, distance))
                elif cost is not None and distance + cost <= depth:
                    queue.append((other, distance + cost))
        return found

    def way(self, from_id: int, to_id: int) -> list[int]:
        """Ids on a way of fewest links from one node to another, both included; empty where none leads there."""
        self.neighbors(from_id)
        before, queue = {to_id: to_id}, deque([to_id] if to_id in self._adjacent else [])
        while queue and from_id not in before:
            at = queue.popleft()
            new = [other for other in self._adjacent[at] if other not in before]
            before |= dict.fromkeys(new, at)
            queue.extend(new)
        if from_id not in before or to_id not in self._adjacent:
            return []
        way = [from_id]
        while way[-1] != to_id:
            way.append(before[way[-1]])
        return way

    def places_beside(self, node_id: int) -> Iterator[tuple[int, Link]]:
        """Linked ids, over intermediate nodes too, each with the link that leaves this node for it."""
        for other, link in self._adjacent[node_id].items():
            if other not in self.between:
                yield other, link
                continue
            ends = (i for i in self._chain(node_id, other) if i not in self.between)
            yield from ((end, link) for end in ends)

    def _chain(self, from_id: int, over: int) -> list[int]:
        """Ids that a walk from one node over an intermediate one comes to, as far as the next that is none."""
        seen, stack, found = {from_id, over}, [over], []
        while stack:
            new = [i for i in self._adjacent[stack.pop()] if i not in seen]
            seen.update(new)
            found.extend(new)
            stack.extend(i for i in new if i in self.between)
        return found

    def component(self, node_id: int) -> set[int]:
        """Ids of all nodes that links join with this one, itself included."""
        self.neighbors(node_id)
        found = {node_id}
        stack = [node_id]
        while stack:
            new = self._adjacent[stack.pop()].keys() - found
            found |= new
            stack.extend(new)
        return found

    @property
    def newest(self) -> int:
        """Largest id; raises OptimizationError when the graph is empty."""
        if not self._adjacent:
            raise OptimizationError("the graph has no node")
        return max(self._adjacent)

    @property
    def correction(self) -> Pose:
        """``T_map_odom`` of the newest node: what takes odometry poses of now into the map."""
        return np.asarray(self.poses[self.newest] @ inverse(self.T_odom[self.newest]))

    @classmethod
    def from_reader(cls, reader: GraphReader) -> Self:
        """The graph of a map file.

        A node without an optimised pose starts where odometry puts it. Merged and dropped nodes (weight -9) and nodes
        without any pose have no place in the graph; markers of merged nodes stay in the file.
        """
        graph, table, poses = cls(), reader.nodes(), reader.poses()
        for number, map_id, weight, T_odom_base in zip(
            table.ids, table.map_ids, table.weights, table.T_odom, strict=True
        ):
            node_id, tracked = int(number), bool(np.isfinite(T_odom_base).all())
            if weight == WEIGHT_INVALID or not (tracked or node_id in poses):
                continue
            T_odom = np.array(T_odom_base) if tracked else poses[node_id]
            graph.add_node(node_id, int(map_id), T_odom, poses.get(node_id, T_odom))
            if weight == WEIGHT_INTERMEDIATE:
                graph.between.add(node_id)
        for link in reader.links():
            if link.T_from_to is not None and link.from_id != link.to_id and graph.has(*link.pair):
                graph.add_link(link)
            elif _is_constraint(link) and link.from_id in graph:
                graph.add_constraint(link)
        return graph


def _is_constraint(link: Link) -> bool:
    if link.T_from_to is None:
        return False
    if link.type is LinkType.LANDMARK:
        return link.to_id < 0 < link.from_id
    return link.type in (LinkType.POSE_PRIOR, LinkType.GRAVITY) and link.to_id == link.from_id


@lru_cache(maxsize=8192)
def ascending(link: Link) -> Link:
    """The same constraint seen from the smaller id.

    Both directions of a link have the same information matrix, as in RTAB-Map's files and optimisers: which way round
    a link is stored must not change the map.
    """
    if link.from_id <= link.to_id or link.T_from_to is None:
        return link
    return Link(link.to_id, link.from_id, link.type, inverse(link.T_from_to), link.information)


def all_ascending(links: Sequence[Link]) -> list[Link]:
    """``ascending`` of many at once, for links that have a transform."""
    stack = inverse(np.array([link.T_from_to for link in links], np.float64).reshape(-1, 4, 4))
    return [
        link if link.from_id <= link.to_id else Link(link.to_id, link.from_id, link.type, T_to_from, link.information)
        for link, T_to_from in zip(links, stack, strict=True)
    ]


def name(link: Link) -> str:
    """How messages call a link: ids as stored and type."""
    return f"{link.from_id}->{link.to_id} ({link.type.label})"
