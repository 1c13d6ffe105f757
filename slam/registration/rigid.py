"""Pose of a view from points that both views measured: RANSAC over three pairs, then all that agree."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, make, normalized
from slam.params import Params

Array = NDArray[np.float64]
_CONFIDENCE = 0.999
#: Median, and the part of 99.7 %, of a squared distance in units of the variance of an axis (chi-squared, 3 degrees).
_MEDIAN = 2.366
_NEARLY_ALL = 13.93
#: No depth camera tells distances finer than this, metres.
_FINEST_M = 1e-3


def solve_rigid(
    points_ref: Array,
    pixels: NDArray[np.float32],
    points_base: NDArray[np.float32],
    camera: Camera,
    params: Params,
    *,
    T_ref_base: Pose | None,
) -> tuple[Pose, NDArray[np.bool_]]:
    """Pose ``T_ref_base`` of the view that measured ``points_base`` where the other has ``points_ref``.

    Args:
        points_ref: (N, 3) points in the reference frame, metres.
        pixels: not used: the same method as ``solve_pnp``.
        points_base: (N, 3) the same points in the view's base frame, NaN where it has no depth.
        camera: not used.
        params: Vis/Iterations, Vis/InlierDistance and Vis/RefineIterations are read.
        T_ref_base: a first guess, if there is one: then the first sample.

    Returns:
        The pose and the inliers (N,); without any pose found, the guess (or identity) and no inliers.
    """
    del pixels, camera
    vis = params.Vis
    rows = np.flatnonzero(np.isfinite(points_base[:, 0]))
    inliers = np.zeros(len(points_ref), np.bool_)
    start = np.eye(4) if T_ref_base is None else T_ref_base
    if len(rows) < 3:
        return start, inliers
    to, of = np.ascontiguousarray(points_ref[rows]), points_base[rows].astype(np.float64)
    R, t, agreed = _ransac(to, of, start[:3, :3].copy(), start[:3, 3].copy(), vis.InlierDistance, vis.Iterations)
    if agreed.sum() < 3:
        return start, inliers
    R, t, agreed = _refine(to, of, R, t, agreed, vis.InlierDistance, vis.RefineIterations)
    inliers[rows] = agreed
    return normalized(make(R, t)), inliers


@njit(cache=True, nogil=True)
def fit(to: Array, of: Array) -> tuple[Array, Array]:
    """Rotation and translation that take ``of`` (N, 3) nearest to ``to`` (N, 3) (Umeyama 1991, without scale)."""
    mean_to, mean_of, C = np.zeros(3), np.zeros(3), np.zeros((3, 3))
    for i in range(len(to)):
        mean_to += to[i] / len(to)
        mean_of += of[i] / len(to)
    for i in range(len(to)):
        C += np.outer(to[i] - mean_to, of[i] - mean_of)
    U, _, Vt = np.linalg.svd(C)
    S = np.eye(3)
    S[2, 2] = 1.0 if np.linalg.det(U) * np.linalg.det(Vt) > 0 else -1.0
    R = U @ S @ Vt
    return R, mean_to - R @ mean_of


@njit(cache=True, nogil=True)
def _squared(to: Array, of: Array, R: Array, t: Array) -> Array:
    gap: Array = to - of @ R.T - t
    squared: Array = (gap * gap).sum(axis=1)
    return squared


@njit(cache=True, nogil=True)
def _ransac(
    to: Array, of: Array, R: Array, t: Array, distance: float, iterations: int
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The sample of three pairs with the most pairs within ``distance``; what is given is the first to beat."""
    limit, count = distance * distance, len(to)
    best = _squared(to, of, R, t) <= limit
    number = best.sum()
    state = np.uint64(88172645463325252)
    needed, tried, drawn = float(iterations), 0, np.zeros(3, np.int64)
    while tried < needed:
        tried += 1
        for k in range(3):
            # Marsaglia's xorshift (2003): the same numbers for every call, so that the same input gives the same pose.
            state ^= state << np.uint64(13)
            state ^= state >> np.uint64(7)
            state ^= state << np.uint64(17)
            drawn[k] = np.int64(state >> np.uint64(33)) % count
        if drawn[0] == drawn[1] or drawn[0] == drawn[2] or drawn[1] == drawn[2]:
            continue
        tried_R, tried_t = fit(to[drawn], of[drawn])
        agreed = _squared(to, of, tried_R, tried_t) <= limit
        if agreed.sum() > number:
            R, t, best, number = tried_R, tried_t, agreed, agreed.sum()
            failing = 1.0 - (number / count) ** 3
            needed = min(needed, np.log(1.0 - _CONFIDENCE) / np.log(failing)) if failing > 0.0 else 0.0
    return R, t, best


@njit(cache=True, nogil=True)
def _refine(
    to: Array, of: Array, R: Array, t: Array, inliers: NDArray[np.bool_], distance: float, rounds: int
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Fits all inliers and chooses them anew, nearer as the fit gets better, until they stay the same."""
    for _ in range(rounds):
        R, t = fit(to[inliers], of[inliers])
        squared = _squared(to, of, R, t)
        spread = max(_FINEST_M * _FINEST_M, np.median(squared[inliers]) / _MEDIAN * _NEARLY_ALL)
        chosen = squared <= min(distance * distance, spread)
        if chosen.sum() < 3 or (chosen == inliers).all():
            break
        inliers = chosen
    return R, t, inliers
