"""Visual registration of two nodes: descriptors, PnP, and why it failed when it did."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.match import match_all, match_near
from slam.geometry import Pose, inverse, transform
from slam.params import Params
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.types import UNKNOWN_VARIANCE, Features, Refusal, Registration

_TEST = "Vis/MinInliers"
#: With a first transform, the points of one view are searched this near where the other should see them.
_NARROW_PX = 10.0


def register(features_from: Features, features_to: Features, camera: Camera, params: Params) -> Registration:
    """Transform between two views of the same place, without a guess.

    Args:
        features_from: their 3D points are used.
        features_to: their pixels (and depth) are used.
        camera: of the second view.
        params: the Vis group is read.

    Returns:
        ``T_from_to`` with covariance and matches, or the refusal: too few matches, or too few inliers.
    """
    with_depth = np.flatnonzero(np.isfinite(features_from.points_base[:, 0]))
    points = features_from.points_base.astype(np.float64)
    descriptors = features_from.descriptors[with_depth]
    matches = _rows(match_all(descriptors, features_to.descriptors, ratio=params.Vis.CorNNDR), with_depth)
    if len(matches) < params.Vis.MinInliers:
        return _refused(matches, np.zeros(len(matches), np.bool_), "matches", params)
    T_from_to, inliers = _solve(points, features_to, matches, camera, params, None)
    if inliers.sum() < params.Vis.MinInliers:
        return _refused(matches, inliers, "inliers", params)
    predicted = camera.project(transform(inverse(T_from_to @ camera.T_base_cam), points[with_depth]))
    near = match_near(
        predicted.astype(np.float32),
        descriptors,
        features_to.pixels,
        features_to.descriptors,
        radius=_NARROW_PX,
        ratio=params.Vis.CorNNDR,
    )
    again = _rows(near, with_depth)
    T_better, agreed = _solve(points, features_to, again, camera, params, T_from_to)
    if agreed.sum() > inliers.sum():
        T_from_to, matches, inliers = T_better, again, agreed
    rows_from, rows_to = matches[inliers].T
    covariance = spread_covariance(points[rows_from], features_to.points_base[rows_to], T_from_to, camera, params)
    return Registration(T_from_to, covariance, matches, inliers)


def _rows(matches: NDArray[np.int32], with_depth: NDArray[np.int64]) -> NDArray[np.int32]:
    """Matches whose first column counts only points with depth, as rows of all features."""
    return np.column_stack([with_depth[matches[:, 0]], matches[:, 1]]).astype(np.int32)


def _solve(
    points: NDArray[np.float64],
    features_to: Features,
    matches: NDArray[np.int32],
    camera: Camera,
    params: Params,
    guess: Pose | None,
) -> tuple[Pose, NDArray[np.bool_]]:
    return solve_pnp(
        points[matches[:, 0]],
        features_to.pixels[matches[:, 1]],
        features_to.points_base[matches[:, 1]],
        camera,
        params,
        T_ref_base=guess,
    )


def _refused(matches: NDArray[np.int32], inliers: NDArray[np.bool_], what: str, params: Params) -> Registration:
    count = len(matches) if what == "matches" else int(inliers.sum())
    threshold = params.Vis.MinInliers
    refusal = Refusal(_TEST, float(count), float(threshold), f"{count} {what}, fewer than {_TEST} {threshold}")
    return Registration(None, np.eye(6) * UNKNOWN_VARIANCE, matches, inliers, refusal)
