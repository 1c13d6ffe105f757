"""Optimised poses of a map that lacks them, from its links alone; nothing is written."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping, Set

from slam.geometry import Pose, inverse
from slam.graph.components import components
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.params import Params
from slam.types import LinkType


def completed(graph: PoseGraph, stored: Mapping[int, Pose], params: Params) -> dict[int, Pose]:
    """Poses ``T_map_base`` of the nodes, and of the landmarks, that ``stored`` lacks and links tell.

    A file of RTAB-Map has poses of what was in working memory at its end, one that was never closed has none. Each
    piece of the graph with a node that lacks one is optimised on its own, from poses put together along its links, and
    laid where the newest of its nodes that is stored has its pose; where none is, its oldest is where odometry has it.
    Nodes that stand alone are left to odometry. The graph's poses are changed on the way.

    Raises:
        OptimizationError: see ``optimize``.
    """
    pieces: defaultdict[int, set[int]] = defaultdict(set)
    for node_id, first in components(graph.poses, graph.links).items():
        pieces[first].add(node_id)
    found: dict[int, Pose] = {}
    for oldest, piece in pieces.items():
        if len(piece) > 1 and not piece <= stored.keys():
            found |= _completed_piece(graph, oldest, piece, stored, params)
    return found


def _completed_piece(
    graph: PoseGraph, oldest: int, piece: Set[int], stored: Mapping[int, Pose], params: Params
) -> dict[int, Pose]:
    graph.poses |= chained(graph, oldest)
    solved = optimize(graph, params, root=oldest)
    known = piece & stored.keys()
    anchor = max(known) if known else oldest
    T = (stored[anchor] if known else graph.poses[oldest]) @ inverse(solved.poses[anchor])
    poses = {node_id: solved.poses[node_id] for node_id in piece} | solved.landmarks
    return {number: T @ pose for number, pose in poses.items() if number not in stored}


def chained(graph: PoseGraph, first: int) -> dict[int, Pose]:
    """Poses put together along links from one node on, those of odometry before loops."""
    found = {first: graph.T_odom[first]}
    queue = deque([first])
    while queue:
        at = queue.popleft()
        for other, link in graph.neighbors(at).items():
            if other in found or link.T_from_to is None:
                continue
            found[other] = found[at] @ (link.T_from_to if link.from_id == at else inverse(link.T_from_to))
            (queue.appendleft if link.type is LinkType.NEIGHBOR else queue.append)(other)
    return found
