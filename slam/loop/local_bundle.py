"""A loop closed with what the neighbours of the old node saw as well, all adjusted together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.match import match_all, match_near
from slam.geometry import Pose, between, flattened, inverse, normalized, transform
from slam.graph.graph import PoseGraph
from slam.loop.bundle import adjust
from slam.params import Params
from slam.registration.inlier_tests import missed
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.registration.view import View
from slam.types import UNKNOWN_VARIANCE, LinkType, Node, Refusal, Registration

_ITERATIONS = 5
#: Points are searched this near where a view whose pose is known should see them.
_NARROW_PX = 10.0
_TEST = "Vis/MinInliers"
Rows = NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """A node beside the old one, and where it was: ``T_old_beside``."""

    view: View
    T_old_beside: Pose


def nodes_beside(old_id: int, nodes: Mapping[int, Node], graph: PoseGraph, params: Params) -> tuple[Beside, ...]:
    """The neighbours of an old node that are in RAM; none unless ``RGBD/LocalBundleOnLoopClosure`` asks for them."""
    if not params.RGBD.LocalBundleOnLoopClosure:
        return ()
    links = dict(graph.places_beside(old_id))
    ids = [i for i in sorted(links) if i in nodes and links[i].type is LinkType.NEIGHBOR]
    return tuple(Beside(View.of(nodes[i]), between(graph.poses[old_id], graph.poses[i])) for i in ids)


def register_bundled(new: View, old: View, beside: Sequence[Beside], params: Params) -> Registration:
    """``T_new_old`` from the points of the old node and of those beside it.

    PnP of the new view against all these points; then five iterations that move the points and the new pose. The old
    poses are held: between neighbours, odometry knows better than the few points that both saw. In ``matches`` the
    row of the old node's features is -1 where only a neighbour saw the point.

    Args:
        new: the view whose pose is looked for.
        old: the place seen again; the cameras of all views must be alike, or nothing is adjusted.
        beside: its neighbours.
        params: the Vis and Reg groups are read.
    """
    cloud = _Points.of(old)
    for item in beside:
        cloud.extend(item.view, item.T_old_beside, params)
    T_old_new, matches, inliers = _located(cloud, new, params)
    if inliers.sum() < params.Vis.MinInliers:
        return _refused(cloud, matches, inliers, params)
    if all(_alike(new.camera, view.camera) for view in (old, *(item.view for item in beside))):
        T_old_new, inliers = _adjusted(cloud, new, T_old_new, matches, inliers)
        if inliers.sum() < params.Vis.MinInliers:
            return _refused(cloud, matches, inliers, params)
    points, rows = cloud.points[matches[inliers, 0]], matches[inliers, 1]
    covariance = spread_covariance(points, new.features.points_base[rows], T_old_new, new.camera, params)
    T_new_old = inverse(T_old_new)
    T_new_old = flattened(T_new_old) if params.Reg.Force3DoF else T_new_old
    found = Registration(T_new_old, covariance, cloud.named(matches), inliers)
    refusal = missed(points, new.features.pixels[rows], covariance, new.camera, params)
    if refusal is None:
        return found
    return replace(found, T_from_to=None, covariance=np.eye(6) * UNKNOWN_VARIANCE, refusal=refusal)


class _Points:
    """Points in the old node's base frame, with the views that saw them."""

    def __init__(self, points: NDArray[np.float64], descriptors: NDArray[np.uint8]) -> None:
        self.points, self.descriptors = points, descriptors
        self.views: list[View] = []
        self.T_old_views: list[Pose] = []
        #: For each view (M, 2) rows: point, feature of that view.
        self.seen: list[Rows] = []

    @classmethod
    def of(cls, old: View) -> _Points:
        found = cls(np.zeros((0, 3)), np.zeros((0, old.features.descriptors.shape[1]), np.uint8))
        found._add(old, np.eye(4), np.zeros((0, 2), np.int32))
        return found

    def extend(self, view: View, T_old_view: Pose, params: Params) -> None:
        """Takes in a view: points it saw again, and those that are new."""
        self._add(view, T_old_view, self.match_near(view, T_old_view, params))

    def match_near(self, view: View, T_old_view: Pose, params: Params) -> Rows:
        """Rows (point, feature) of the points that a view with a known pose sees."""
        points_cam = transform(inverse(T_old_view @ view.camera.T_base_cam), self.points)
        predicted = view.camera.project(points_cam).astype(np.float32)
        features = view.features
        return match_near(
            predicted,
            self.descriptors,
            features.pixels,
            features.descriptors,
            radius=_NARROW_PX,
            ratio=params.Vis.CorNNDR,
        )

    def named(self, matches: Rows) -> Rows:
        """Matches (point, feature of the new view) as (row of the new view, row of the old node or -1)."""
        old_row = np.full(len(self.points), -1, np.int32)
        old_row[self.seen[0][:, 0]] = self.seen[0][:, 1]
        return np.column_stack([matches[:, 1], old_row[matches[:, 0]]]).astype(np.int32)

    def _add(self, view: View, T_old_view: Pose, again: Rows) -> None:
        fresh = np.isfinite(view.features.points_base[:, 0])
        fresh[again[:, 1]] = False
        rows = np.flatnonzero(fresh)
        numbers = np.arange(len(rows)) + len(self.points)
        self.points = np.concatenate([self.points, transform(T_old_view, view.features.points_base[rows])])
        self.descriptors = np.concatenate([self.descriptors, view.features.descriptors[rows]])
        self.views.append(view)
        self.T_old_views.append(T_old_view)
        self.seen.append(np.concatenate([again, np.column_stack([numbers, rows])]).astype(np.int32))


def _located(cloud: _Points, new: View, params: Params) -> tuple[Pose, Rows, NDArray[np.bool_]]:
    """``T_old_new`` by PnP, matches (point, feature) and inliers; once more, nearer, with ``Reg/RepeatOnce``."""
    matches = match_all(cloud.descriptors, new.features.descriptors, ratio=params.Vis.CorNNDR)
    if len(matches) < params.Vis.MinInliers:
        return np.eye(4), matches, np.zeros(len(matches), np.bool_)
    T_old_new, inliers = _solve(cloud, new, matches, None, params)
    if not params.Reg.RepeatOnce or inliers.sum() < params.Vis.MinInliers:
        return T_old_new, matches, inliers
    again = cloud.match_near(new, T_old_new, params)
    T_better, agreed = _solve(cloud, new, again, T_old_new, params)
    better = agreed.sum() > inliers.sum()
    return (T_better, again, agreed) if better else (T_old_new, matches, inliers)


def _solve(
    cloud: _Points, new: View, matches: Rows, guess: Pose | None, params: Params
) -> tuple[Pose, NDArray[np.bool_]]:
    features = new.features
    pixels, points_base = features.pixels[matches[:, 1]], features.points_base[matches[:, 1]]
    return solve_pnp(cloud.points[matches[:, 0]], pixels, points_base, new.camera, params, T_ref_base=guess)


def _adjusted(
    cloud: _Points, new: View, T_old_new: Pose, matches: Rows, inliers: NDArray[np.bool_]
) -> tuple[Pose, NDArray[np.bool_]]:
    """The new pose and the points that fit best; points that only one view saw say nothing and are left out."""
    agreed = np.flatnonzero(inliers)
    seen = [*cloud.seen, matches[agreed]]
    views, poses = [*cloud.views, new], [*cloud.T_old_views, T_old_new]
    times = np.bincount(np.concatenate([rows[:, 0] for rows in seen]), minlength=len(cloud.points))
    used = np.flatnonzero(times > 1)
    number = np.full(len(cloud.points), -1, np.int32)
    number[used] = np.arange(len(used))
    columns = [_observations(k, view, number, rows) for k, (view, rows) in enumerate(zip(views, seen, strict=True))]
    obs_pose, obs_point, pixels, inverse_depths = (np.concatenate(column) for column in zip(*columns, strict=True))
    order = np.argsort(obs_point, kind="stable")
    T_cam_old = np.stack([inverse(T @ view.camera.T_base_cam) for T, view in zip(poses, views, strict=True)])
    camera = new.camera
    adjusted, points, good, _, _ = adjust(
        T_cam_old,
        cloud.points[used],
        obs_pose[order],
        obs_point[order],
        pixels[order],
        inverse_depths[order],
        np.array([camera.fx, camera.fy, camera.cx, camera.cy]),
        len(cloud.views),
        _ITERATIONS,
    )
    cloud.points[used] = points
    good_points = np.zeros(len(used), np.bool_)
    good_points[obs_point[order][good & (obs_pose[order] == len(views) - 1)]] = True
    kept = inliers.copy()
    kept[agreed] = (number[matches[agreed, 0]] >= 0) & good_points[number[matches[agreed, 0]]]
    return normalized(inverse(adjusted[-1]) @ inverse(camera.T_base_cam)), kept


def _observations(
    k: int, view: View, number: Rows, rows: Rows
) -> tuple[Rows, Rows, NDArray[np.float64], NDArray[np.float64]]:
    """Columns pose, point, pixel and inverse depth of what view k saw of the points with a number."""
    rows = rows[number[rows[:, 0]] >= 0]
    depths = transform(inverse(view.camera.T_base_cam), view.features.points_base[rows[:, 1]])[:, 2]
    pixels = view.features.pixels[rows[:, 1]].astype(np.float64)
    return np.full(len(rows), k, np.int32), number[rows[:, 0]], pixels, 1.0 / depths


def _alike(a: Camera, b: Camera) -> bool:
    return (a.fx, a.fy, a.cx, a.cy) == (b.fx, b.fy, b.cx, b.cy)


def _refused(cloud: _Points, matches: Rows, inliers: NDArray[np.bool_], params: Params) -> Registration:
    count, least = int(inliers.sum()), params.Vis.MinInliers
    text = f"{count} inliers of {len(matches)} matches, fewer than {_TEST} {least}"
    refusal = Refusal(_TEST, float(count), float(least), text)
    return Registration(None, np.eye(6) * UNKNOWN_VARIANCE, cloud.named(matches), inliers, refusal)
