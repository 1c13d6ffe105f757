"""Pose of a view from 3D points and their pixels: RANSAC, refinement, and a covariance from the spread."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, inverse, make, transform
from slam.params import Params
from slam.registration.pose import refine_pose

Array = NDArray[np.float64]
#: A first guess that explains this share of the matches makes RANSAC needless.
_GUESS_SUFFICES = 0.5
#: So does one that explains as many as this, however many wrong matches a wide search has brought.
_PLENTY = 100
#: Converts a squared median deviation to a variance (1.4826 squared, Rousseeuw and Croux 1993).
_MEDIAN_TO_VARIANCE = 2.1981
#: With fewer depths than this the view's own points are guessed, by lengthening their rays from the other's.
_LEAST_DEPTHS = 4
_GUESSED_DEPTH = 1.1
#: ``Vis/PnPFlags`` of RANSAC's samples; what follows is the same for all.
_SOLVERS = (cv2.SOLVEPNP_AP3P, cv2.SOLVEPNP_EPNP, cv2.SOLVEPNP_P3P)
_LINEAR_FLOOR = 1e-8
_ANGULAR_FLOOR = 3e-8


def solve_pnp(
    points_ref: Array,
    pixels: NDArray[np.float32],
    points_base: NDArray[np.float32],
    camera: Camera,
    params: Params,
    *,
    T_ref_base: Pose | None,
    rounds: int = 3,
) -> tuple[Pose, NDArray[np.bool_]]:
    """Pose ``T_ref_base`` of the view that sees ``points_ref`` at ``pixels``, and which matches agree.

    Args:
        points_ref: (N, 3) points in the reference frame, metres; N >= 4.
        pixels: (N, 2) where the view sees them.
        points_base: (N, 3) what the view's own depth says of them, NaN where it is silent.
        camera: of the view.
        params: Vis/Iterations and Vis/PnPReprojError are read.
        T_ref_base: a first guess, if there is one.
        rounds: how often a refinement chooses outliers anew.

    Returns:
        The pose and the inliers (N,); without any pose found, the guess (or identity) and no inliers.
    """
    intrinsics = np.array([camera.fx, camera.fy, camera.cx, camera.cy])
    T_cam_base = inverse(camera.T_base_cam)
    inverse_depth = 1.0 / transform(T_cam_base, points_base)[:, 2]
    pixels64 = pixels.astype(np.float64)
    none = np.zeros(len(pixels), np.bool_)
    best, inliers = (np.eye(4) if T_ref_base is None else T_ref_base), none
    if T_ref_base is not None:
        T_cam_ref = T_cam_base @ inverse(T_ref_base)
        T_cam_ref, inliers = refine_pose(T_cam_ref, points_ref, pixels64, inverse_depth, intrinsics, rounds=rounds)
        best = inverse(T_cam_ref) @ T_cam_base
    if inliers.sum() < min(_GUESS_SUFFICES * len(inliers), _PLENTY):
        found = _ransac(points_ref, pixels64, camera, params)
        if found is not None:
            T_cam_ref, agreed = refine_pose(found, points_ref, pixels64, inverse_depth, intrinsics)
            if agreed.sum() > inliers.sum():
                best, inliers = inverse(T_cam_ref) @ T_cam_base, agreed
    return best, inliers


def _ransac(points_ref: Array, pixels: Array, camera: Camera, params: Params) -> Pose | None:
    # OpenCV seeds this RANSAC with a constant, so that the same input gives the same pose.
    found, rotation, translation, _ = cv2.solvePnPRansac(
        points_ref,
        pixels,
        camera.K,
        None,
        iterationsCount=params.Vis.Iterations,
        reprojectionError=params.Vis.PnPReprojError,
        confidence=0.999,
        flags=_SOLVERS[params.Vis.PnPFlags],
    )
    if not found or not np.isfinite(rotation).all() or not np.isfinite(translation).all():
        return None
    return make(np.asarray(cv2.Rodrigues(rotation)[0]), np.asarray(translation))


def spread_covariance(
    points_ref: Array, points_base: NDArray[np.float32], T_ref_base: Pose, camera: Camera, params: Params
) -> Array:
    """(6, 6) covariance from how far the inliers' points lie apart in both views.

    The linear variance is the n/``Vis/PnPVarianceMedianRatio``-th smallest squared distance, the angular one the
    same of the squared angle between both rays from the camera; each times 2.1981. (RTAB-Map takes the angle itself,
    not its square.) A turn and a sidestep look alike at the depth of the scene, so that the angular sigma is at least
    the linear one over the median depth. A view without depth is taken to be a tenth of it wrong, as RTAB-Map does.
    With ``Vis/PnPSplitLinearCovComponents`` each axis of the view's base frame has its own linear variance.
    """
    T_cam_ref = inverse(T_ref_base @ camera.T_base_cam)
    expected = transform(T_cam_ref, points_ref)
    measured = transform(inverse(camera.T_base_cam), points_base)
    known = np.isfinite(measured[:, 2])
    if known.sum() < _LEAST_DEPTHS:
        measured = np.where(known[:, None], measured, _GUESSED_DEPTH * expected)
    else:
        expected, measured = expected[known], measured[known]
    squared = np.sum((expected - measured) ** 2, axis=1)
    cosine = np.sum(expected * measured, axis=1) / (np.linalg.norm(expected, axis=1) * np.linalg.norm(measured, axis=1))
    angles = np.arccos(np.clip(cosine, -1.0, 1.0))
    k = len(squared) // params.Vis.PnPVarianceMedianRatio
    linear = max(_LINEAR_FLOOR, _MEDIAN_TO_VARIANCE * float(np.partition(squared, k)[k]))
    axes = [linear] * 3
    if params.Vis.PnPSplitLinearCovComponents:
        apart = ((expected - measured) @ camera.T_base_cam[:3, :3].T) ** 2
        axes = np.maximum(_LINEAR_FLOOR, _MEDIAN_TO_VARIANCE * np.partition(apart, k, axis=0)[k]).tolist()
    sidestep = linear / float(np.median(expected[:, 2])) ** 2
    angular = max(_ANGULAR_FLOOR, sidestep, _MEDIAN_TO_VARIANCE * float(np.partition(angles, k)[k]) ** 2)
    return np.diag(axes + [angular] * 3)
