"""Proximity detection by space: old nodes that should be close by, one from each path (Labbe and Michaud 2019)."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.types import LinkType


def nearby(
    node_id: int,
    places: Collection[int],
    graph: PoseGraph,
    likelihood: Mapping[int, float],
    params: Params,
    *,
    home: int = 0,
) -> list[int]:
    """Nodes of working memory to register with, at most one for each path, most likely path first.

    Args:
        node_id: the new node.
        places: ids in working memory.
        graph: optimised poses and links.
        likelihood: id -> likelihood of this update, where known.
        params: the Proximity parameters of RGBD are read; the graph's depth counts only while mapping.
        home: a node of the graph that the new one is in, where no link tells (0: the new one itself).
    """
    T_map_new = graph.poses[node_id]
    around, paths = paths_around(node_id, places, graph, likelihood, params, home=home)
    linked = dict(graph.places_beside(node_id))
    chosen: list[int] = []
    for path in paths:
        close = [
            i
            for i in path
            if around[i] <= params.RGBD.ProximityPathFilteringRadius
            and _facing_deg(T_map_new, graph.poses[i]) <= params.RGBD.ProximityAngle
        ]
        if close and not any(i in linked for i in path):
            chosen.append(max(close, key=lambda i: (likelihood.get(i, 0.0), -around[i], i)))
    return chosen


def paths_around(
    node_id: int,
    places: Collection[int],
    graph: PoseGraph,
    likelihood: Mapping[int, float],
    params: Params,
    *,
    home: int = 0,
) -> tuple[dict[int, float], list[list[int]]]:
    """Nodes of working memory around a node with their distance in metres, and the paths they lie on.

    The paths are those that are tried, ``RGBD/ProximityMaxPaths`` at most, the most likely first. ``home`` is as above.
    """
    T_map_new = graph.poses[node_id]
    depth = params.RGBD.ProximityMaxGraphDepth if params.Mem.IncrementalMemory else 0
    start = home or node_id
    reachable = graph.within(start, depth).keys() if depth else graph.component(start)
    around = {
        place: _distance(T_map_new, graph.poses[place])
        for place in places
        if place in reachable and _distance(T_map_new, graph.poses[place]) <= params.RGBD.LocalRadius
    }
    paths = sorted(_paths(around, graph), key=lambda path: -max(likelihood.get(i, 0.0) for i in path))
    return around, paths[: params.RGBD.ProximityMaxPaths or None]


def _paths(ids: Mapping[int, float], graph: PoseGraph) -> list[list[int]]:
    """``ids`` cut into runs that neighbour links join, each ascending."""
    left, paths = set(ids), []
    for start in sorted(ids):
        if start not in left:
            continue
        left.remove(start)
        path, stack = [], [start]
        while stack:
            at = stack.pop()
            path.append(at)
            for other, link in graph.places_beside(at):
                if other in left and link.type in (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED):
                    left.remove(other)
                    stack.append(other)
        paths.append(sorted(path))
    return paths


def _distance(T_map_a: Pose, T_map_b: Pose) -> float:
    return float(np.linalg.norm(T_map_a[:3, 3] - T_map_b[:3, 3]))


def _facing_deg(T_map_a: Pose, T_map_b: Pose) -> float:
    """Angle in degrees between the forward axes of two nodes."""
    return float(np.degrees(np.arccos(np.clip(T_map_a[:3, 0] @ T_map_b[:3, 0], -1.0, 1.0))))
