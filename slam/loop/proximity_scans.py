"""Proximity by scans: a node's cloud against the merged clouds of an old path near by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from slam.geometry import Pose, between, inverse, transform
from slam.graph.graph import PoseGraph
from slam.loop.proximity import paths_around
from slam.memory.memory import Memory
from slam.params import Params
from slam.registration.icp import IcpRegistration
from slam.registration.view import View
from slam.types import Candidate, LinkType, Node, Registration, Scan


def by_scans(
    node: Node,
    memory: Memory,
    graph: PoseGraph,
    likelihood: Mapping[int, float],
    found: Sequence[Candidate],
    params: Params,
) -> list[Candidate]:
    """ICP with the nearest node of each path near by, its neighbours' clouds merged into its own.

    Args:
        node: the new one; it has a cloud.
        memory: the old ones are in working memory.
        graph: optimised poses and links.
        likelihood: id -> likelihood of this update, where known.
        found: what was looked at in this update: paths that are joined by it already are left alone.
        params: the Proximity parameters of RGBD and the Icp group are read.
    """
    around, paths = paths_around(node.id, memory.wm, graph, likelihood, params)
    joined = {*dict(graph.places_beside(node.id)), *(c.to_id for c in found if c.refusal is None)}
    candidates = []
    for path in paths:
        nearest = min(path, key=lambda i: (around[i], i))
        if around[nearest] > params.RGBD.ProximityPathFilteringRadius or joined.intersection(path):
            continue
        poses = poses_along(nearest, path, graph, params)
        merged = _merged({i: T for i, T in poses.items() if memory.nodes[i].scan is not None}, memory)
        if merged is not None:
            guess = between(graph.poses[nearest], graph.poses[node.id])
            candidates.append(_compared(node, memory.nodes[nearest], merged, guess, params))
    return candidates


def poses_along(nearest: int, path: Sequence[int], graph: PoseGraph, params: Params) -> dict[int, Pose]:
    """``T_nearest_i`` of the node and up to ``RGBD/ProximityPathMaxNeighbors`` of the path on each side of it."""
    left, poses = set(path) - {nearest}, {nearest: np.eye(4)}
    ends = [nearest, nearest]
    for _ in range(params.RGBD.ProximityPathMaxNeighbors):
        for side in (0, 1):
            at = ends[side]
            following = [i for i in sorted(dict(graph.places_beside(at))) if i in left and (i < at) == (side == 0)]
            if not following:
                continue
            # Backwards the newest that is older, forwards the oldest that is newer.
            ends[side] = following[-1] if side == 0 else following[0]
            left.remove(ends[side])
            poses[ends[side]] = _step(poses[at], at, ends[side], nearest, graph, params)
    return poses


def _step(T_nearest_at: Pose, at: int, to: int, nearest: int, graph: PoseGraph, params: Params) -> Pose:
    """``T_nearest_to`` by the link between both nodes, or by the optimised poses."""
    link = graph.neighbors(at).get(to)
    if not params.RGBD.ProximityPathRawPosesUsed or link is None or link.T_from_to is None:
        return between(graph.poses[nearest], graph.poses[to])
    T_at_to = link.T_from_to if link.from_id == at else inverse(link.T_from_to)
    return np.asarray(T_nearest_at @ T_at_to)


def _merged(poses: Mapping[int, Pose], memory: Memory) -> Scan | None:
    """The clouds of all these nodes in one frame; None when none has any."""
    scans = [(T, memory.nodes[i].scan) for i, T in sorted(poses.items())]
    clouds = [transform(T, scan.points_base) for T, scan in scans if scan is not None]
    if not clouds:
        return None
    return Scan(np.concatenate(clouds).astype(np.float32), most=max(len(cloud) for cloud in clouds))


def _compared(node: Node, old: Node, merged: Scan, guess: Pose, params: Params) -> Candidate:
    """The candidate ``T_new_old`` of ICP between the merged cloud and the new node's.

    As RTAB-Map does: the correspondence ratio is doubled, for the merged cloud covers more than one look, and the
    covariance is ``RGBD/ProximityMergedScanCovFactor`` times that of ICP.
    """
    ratio = min(1.0, 2.0 * params.Icp.CorrespondenceRatio)
    stricter = params.changed({"Icp/CorrespondenceRatio": ratio})
    place = replace(View.of(old), scan=merged)
    found: Registration = IcpRegistration().register(place, View.of(node), guess, stricter)
    information, factor = None, params.RGBD.ProximityMergedScanCovFactor
    if found.T_from_to is not None:
        information = np.asarray(np.linalg.inv(found.covariance * factor), np.float64)
    points = 0 if found.icp is None else found.icp.points
    return Candidate(
        from_id=node.id,
        to_id=old.id,
        type=LinkType.LOCAL_SPACE_CLOSURE,
        posterior=float("nan"),
        matches=points if found.icp is not None else -1,
        inliers=round(found.icp.ratio * points) if found.icp is not None else -1,
        T_from_to=None if found.T_from_to is None else inverse(found.T_from_to),
        information=information,
        refusal=found.refusal,
        by_scans=True,
    )
