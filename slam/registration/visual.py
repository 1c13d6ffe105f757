"""Visual registration of two nodes: correspondences, a robust pose, and why it failed when it did."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, flattened
from slam.params import Params
from slam.registration.correspondences import Correspondences, Matching, OpticalFlow
from slam.registration.inlier_tests import missed
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.registration.rigid import solve_rigid
from slam.registration.view import View, refused
from slam.types import UNKNOWN_VARIANCE, Features, Refusal, Registration

_TEST = "Vis/MinInliers"
#: With a first transform, the points of one view are searched this near where the other should see them.
_NARROW_PX = 10.0


def register(features_from: Features, features_to: Features, camera: Camera, params: Params) -> Registration:
    """Transform between two views of the same place by their key points alone, without a guess.

    Args:
        features_from: their 3D points are used.
        features_to: their pixels (and depth) are used.
        camera: of the second view.
        params: the Vis group is read.

    Returns:
        ``T_from_to`` with covariance and matches, or the refusal: too few matches, or too few inliers.
    """
    return VisualRegistration().register(View(features_from, camera), View(features_to, camera), None, params)


class VisualRegistration:
    """Key points and their depth: PnP (``Vis/EstimationType`` 1) or 3D-3D (0)."""

    def register(self, view_from: View, view_to: View, guess: Pose | None, params: Params) -> Registration:
        """``T_from_to`` with its evidence, or the test of the Vis group that refused it."""
        if params.Vis.CorType == 1 and (view_from.images is None or view_to.images is None):
            text = "no images at hand, which Vis/CorType 1 (optical flow) needs: nodes keep them from when it is set"
            return refused(Refusal("Vis/CorType", 0.0, 2.0, text))
        corresponding = Matching() if params.Vis.CorType == 0 else OpticalFlow()
        points = view_from.features.points_base.astype(np.float64)
        pairs = corresponding.between(view_from, view_to, guess, float(params.Vis.CorGuessWinSize), params)
        if len(pairs.rows) < params.Vis.MinInliers:
            return _refused(pairs.rows, np.zeros(len(pairs.rows), np.bool_), "matches", params)
        T_from_to, inliers = _solve(points, pairs, view_to.camera, params, guess)
        if inliers.sum() < params.Vis.MinInliers:
            return _refused(pairs.rows, inliers, "inliers", params)
        if guess is not None or params.Reg.RepeatOnce:
            again = corresponding.between(view_from, view_to, T_from_to, _NARROW_PX, params)
            T_better, agreed = _solve(points, again, view_to.camera, params, T_from_to)
            if agreed.sum() > inliers.sum():
                T_from_to, pairs, inliers = T_better, again, agreed
        return _judged(points, pairs, inliers, T_from_to, view_to.camera, params)


def _solve(
    points: NDArray[np.float64], pairs: Correspondences, camera: Camera, params: Params, guess: Pose | None
) -> tuple[Pose, NDArray[np.bool_]]:
    solve = solve_pnp if params.Vis.EstimationType == 1 else solve_rigid
    return solve(
        points[pairs.rows[:, 0]],
        pairs.features_to.pixels[pairs.rows[:, 1]],
        pairs.features_to.points_base[pairs.rows[:, 1]],
        camera,
        params,
        T_ref_base=guess,
    )


def _judged(
    points: NDArray[np.float64],
    pairs: Correspondences,
    inliers: NDArray[np.bool_],
    T_from_to: Pose,
    camera: Camera,
    params: Params,
) -> Registration:
    """The result with its covariance, unless one of the optional tests refuses it."""
    rows_from, rows_to = pairs.rows[inliers].T
    measured = pairs.features_to.points_base[rows_to]
    covariance = spread_covariance(points[rows_from], measured, T_from_to, camera, params)
    found = Registration(flattened(T_from_to) if params.Reg.Force3DoF else T_from_to, covariance, pairs.rows, inliers)
    refusal = missed(points[rows_from], pairs.features_to.pixels[rows_to], covariance, camera, params)
    if refusal is None:
        return found
    return replace(found, T_from_to=None, covariance=np.eye(6) * UNKNOWN_VARIANCE, refusal=refusal)


def _refused(matches: NDArray[np.int32], inliers: NDArray[np.bool_], what: str, params: Params) -> Registration:
    count = len(matches) if what == "matches" else int(inliers.sum())
    threshold, of_one = params.Vis.MinInliers, {"matches": "match", "inliers": "inlier"}
    said = f"{count} {of_one[what] if count == 1 else what}, fewer than {_TEST} {threshold}"
    refusal = Refusal(_TEST, float(count), float(threshold), said)
    return Registration(None, np.eye(6) * UNKNOWN_VARIANCE, matches, inliers, refusal)
