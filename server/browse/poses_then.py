"""Where the nodes of a map were taken to be after each of its updates."""

from __future__ import annotations

import threading
import time
from bisect import bisect_right
from collections import OrderedDict, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise

from server.browse.snapshot import Pair
from server.browse.timeline import Timeline
from slam.geometry import Pose, inverse
from slam.graph.components import components
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import choose_root, optimize
from slam.types import Link, LinkType

#: Turning points that are kept, by the number of poses in them.
_KEPT_POSES = 200_000
#: An optimisation that is expected to take no longer than this is made while somebody scrubs.
_QUICK_S = 0.02
#: What optimising a graph takes at first sight, seconds by node.
_FIRST_GUESS_S = 1e-4


class PosesThen:
    """The graph of any moment, optimised with the links that it had then.

    A map file has the optimised poses of its end alone. Between two turning points (updates in which a loop came or
    went, or a session began) nodes only came to the end of the path, so that one optimisation serves all updates up to
    the next; it begins at the poses of now, whatever was asked for before. A session that no loop joined yet, and a map
    whose root gravity or priors may turn, lie where their newest node was thought to be then, if the file says so.
    """

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._lock = threading.Lock()
        self._turns = sorted({*_first_of_sessions(timeline), *timeline.turns})
        self._recorded = {move.id: move.T_map_base for move in timeline.moves if move.T_map_base is not None}
        self._solved: OrderedDict[int, Mapping[int, Pose]] = OrderedDict()
        self._seconds_by_node = _FIRST_GUESS_S

    def turn(self, at: int) -> int:
        """The turning point that the poses of a moment come from; 0 before the first."""
        place = bisect_right(self._turns, at)
        return self._turns[place - 1] if place else 0

    def is_quick(self, at: int) -> bool:
        """Whether ``poses`` answers at once."""
        nodes = bisect_right(self._timeline.snapshot.nodes.ids, at)
        return self.turn(at) in self._solved or nodes * self._seconds_by_node < _QUICK_S

    def poses(self, at: int) -> dict[int, Pose]:
        """``T_map_base`` of all nodes that were there at a moment.

        Raises:
            OptimizationError: the graph of then can't be optimised.
        """
        turn = self.turn(at)
        with self._lock:
            found = self._solved.get(turn)
            if found is None:
                start = time.perf_counter()
                found = self._solved[turn] = self._optimised(turn)
                self._seconds_by_node = (time.perf_counter() - start) / max(1, len(found))
            self._solved.move_to_end(turn)
            while len(self._solved) > max(1, _KEPT_POSES // max(1, len(found))):
                self._solved.popitem(last=False)
        return self._carried_on(found, turn, at)

    def _optimised(self, turn: int) -> Mapping[int, Pose]:
        graph = graph_then(self._timeline, turn)
        pieces: defaultdict[int, list[int]] = defaultdict(list)
        for node_id, first in components(graph.poses, graph.links).items():
            pieces[first].append(node_id)
        found: dict[int, Pose] = {}
        for piece in pieces.values():
            solved = graph.poses
            if len(piece) > 1:
                root = choose_root(graph, self._timeline.snapshot.params, max(piece))
                solved = optimize(graph, self._timeline.snapshot.params, root=root).poses
            held = min(piece) == min(graph.poses) and not self._is_free(graph)
            T = None if held else self._anchor(solved, piece)
            found |= {i: solved[i] if T is None else T @ solved[i] for i in piece}
        return found

    def _is_free(self, graph: PoseGraph) -> bool:
        """Whether the root itself may have turned since: gravity and priors hold the map, not the root."""
        optimizer, kinds = self._timeline.snapshot.params.Optimizer, {kind for _, _, kind in graph.constraints}
        gravity = LinkType.GRAVITY in kinds and optimizer.GravitySigma > 0
        return gravity or (LinkType.POSE_PRIOR in kinds and not optimizer.PriorsIgnored)

    def _anchor(self, solved: Mapping[int, Pose], piece: Iterable[int]) -> Pose | None:
        """What takes a session of its own to where its newest node was thought to be; None where nobody wrote that."""
        newest = max((i for i in piece if i in self._recorded), default=None)
        return None if newest is None else self._recorded[newest] @ inverse(solved[newest])

    def _carried_on(self, solved: Mapping[int, Pose], turn: int, at: int) -> dict[int, Pose]:
        """With the nodes that came since, each where its link to an older one puts it."""
        snapshot, found = self._timeline.snapshot, dict(solved)
        ids = snapshot.nodes.ids
        for node_id in ids[bisect_right(ids, turn) : bisect_right(ids, at)].tolist():
            # Nothing leads there from an older node: it stays where it is now.
            pose = next(self._linked(node_id, found), snapshot.poses.get(node_id))
            if pose is not None:
                found[node_id] = pose
        return found

    def _linked(self, node_id: int, found: Mapping[int, Pose]) -> Iterator[Pose]:
        """Where links with older nodes put a node, by the path first."""
        links = [link for link in self._timeline.snapshot.links_at.get(node_id, []) if not link.type.is_loop]
        for link in sorted(links, key=lambda one: one.type is not LinkType.NEIGHBOR):
            other = link.from_id if link.to_id == node_id else link.to_id
            if other < node_id and other in found and link.T_from_to is not None:
                yield found[other] @ (link.T_from_to if link.from_id == other else inverse(link.T_from_to))


def graph_then(timeline: Timeline, at: int) -> PoseGraph:
    """The nodes, links and constraints that were there at a moment, at the poses of now."""
    snapshot, graph = timeline.snapshot, PoseGraph()
    now = snapshot.graph
    for node_id in sorted(now.poses):
        if 0 < node_id <= at:
            graph.add_node(node_id, now.map_ids[node_id], now.T_odom[node_id], now.poses[node_id])
    graph.between |= now.between & graph.poses.keys()
    moment, measured = timeline.moment(at), _measured_loops(timeline)
    for link in (*_path_links(timeline), *(measured[pair] for pair in moment.loops if pair in measured)):
        if graph.has(*link.pair) and link.pair not in graph.links and link.T_from_to is not None:
            graph.add_link(link)
    for (from_id, _, _), link in now.constraints.items():
        if from_id in graph:
            graph.add_constraint(link)
    return graph


def _path_links(timeline: Timeline) -> Iterator[Link]:
    return (link for link in timeline.links_before.values() if link is not None and not link.type.is_loop)


def _measured_loops(timeline: Timeline) -> dict[Pair, Link]:
    """The transform of each loop that was ever accepted: as people found it, or as its last candidate had it."""
    tried = {pair: row.candidate.link for pair, row in timeline.snapshot.candidates.items()}
    found = {pair: link for pair, link in tried.items() if link is not None}
    return found | {p: link for p, link in timeline.links_before.items() if link is not None and link.type.is_loop}


def _first_of_sessions(timeline: Timeline) -> Iterator[int]:
    nodes = timeline.snapshot.nodes
    ids, sessions = nodes.ids.tolist(), nodes.map_ids.tolist()
    yield from ids[:1]
    yield from (ids[row] for row, (before, after) in enumerate(pairwise(sessions), start=1) if before != after)
