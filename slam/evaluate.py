"""How well a trajectory agrees with ground truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.errors import SlamError
from slam.geometry import Pose, inverse, make, so3_log
from slam.stamps import pair_nearest

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AbsoluteError:
    """Absolute trajectory error: distances between positions after rigid alignment.

    Attributes:
        rmse_m: root of the mean squared distance.
        mean_m: mean distance.
        median_m: median distance.
        max_m: largest distance.
        pairs: number of poses compared.
    """

    rmse_m: float
    mean_m: float
    median_m: float
    max_m: float
    pairs: int


@dataclass(frozen=True, slots=True)
class RelativeError:
    """Relative pose error: drift over a step of the trajectory.

    Attributes:
        translation_rmse: metres of error per unit of the step (per metre or per second).
        rotation_rmse_deg: degrees of error per unit of the step.
        pairs: number of steps compared; with none, both errors are NaN.
    """

    translation_rmse: float
    rotation_rmse_deg: float
    pairs: int


def associated(
    truth_stamps: Array, truth: Array, stamps: Array, estimate: Array, within_s: float = 0.02
) -> tuple[Array, Array]:
    """Poses (P, 4, 4) of truth and of the estimate that belong to the same moments, for the errors below.

    Args:
        truth_stamps: (N,) seconds, ascending.
        truth: (N, 4, 4).
        stamps: (M,) seconds, ascending.
        estimate: (M, 4, 4).
        within_s: greatest difference of two stamps that are taken for one moment.
    """
    pairs = pair_nearest(truth_stamps, stamps, within_s)
    return truth[pairs[:, 0]], estimate[pairs[:, 1]]


def align(points_a: Array, points_b: Array) -> Pose:
    """T_a_b that brings points b (N, 3) closest to points a (N, 3), without scale (Umeyama 1991, equations 39 to 42).

    With fewer than three points, or all on a line, the rotation that is left open is any one that fits.

    Raises:
        SlamError: the sets are empty or differ in length.
    """
    if len(points_a) != len(points_b) or not len(points_a):
        raise SlamError(
            f"{len(points_a)} true and {len(points_b)} found positions; to compare them takes as many of both, "
            "and at least one"
        )
    mean_a, mean_b = points_a.mean(axis=0), points_b.mean(axis=0)
    U, _, Vt = np.linalg.svd((points_a - mean_a).T @ (points_b - mean_b))
    turn = np.diag([1.0, 1.0, np.sign(np.linalg.det(U) * np.linalg.det(Vt))])
    R_a_b = U @ turn @ Vt
    return make(R_a_b, mean_a - R_a_b @ mean_b)


def absolute_error(truth: Sequence[Pose] | Array, estimate: Sequence[Pose] | Array) -> AbsoluteError:
    """ATE of an estimate against truth, both (N, 4, 4) with row i of the same moment.

    Raises:
        SlamError: the trajectories are empty or differ in length.
    """
    positions = np.asarray(truth, np.float64).reshape(-1, 4, 4)[:, :3, 3]
    found = np.asarray(estimate, np.float64).reshape(-1, 4, 4)[:, :3, 3]
    T_truth_estimate = align(positions, found)
    errors = np.linalg.norm(found @ T_truth_estimate[:3, :3].T + T_truth_estimate[:3, 3] - positions, axis=1)
    return AbsoluteError(
        rmse_m=float(np.sqrt(np.mean(errors**2))),
        mean_m=float(errors.mean()),
        median_m=float(np.median(errors)),
        max_m=float(errors.max()),
        pairs=len(errors),
    )


def error_per_metre(truth: Array, estimate: Array, step_m: float = 1.0) -> RelativeError:
    """RPE over steps of ``step_m`` metres of the true path, per metre; trajectories (N, 4, 4)."""
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(truth[:, :3, 3], axis=0), axis=1))])
    return _relative(truth, estimate, way, step_m)


def error_per_second(truth: Array, estimate: Array, stamps: Array, step_s: float = 1.0) -> RelativeError:
    """RPE over steps of ``step_s`` seconds, per second; trajectories (N, 4, 4), stamps (N,) seconds, ascending."""
    return _relative(truth, estimate, stamps, step_s)


def _relative(truth: Array, estimate: Array, way: Array, step: float) -> RelativeError:
    """Errors of all steps i -> first j that is at least ``step`` further, divided by the length of the step."""
    ends = np.searchsorted(way, way + step * (1.0 - 1e-9))
    starts = np.flatnonzero(ends < len(way))
    ends = ends[starts]
    if not len(starts):
        return RelativeError(float("nan"), float("nan"), 0)
    true_steps = inverse(truth[starts]) @ truth[ends]
    found_steps = inverse(estimate[starts]) @ estimate[ends]
    errors = inverse(true_steps) @ found_steps
    lengths = way[ends] - way[starts]
    shifts = np.linalg.norm(errors[:, :3, 3], axis=1) / lengths
    turns = np.degrees([np.linalg.norm(so3_log(error[:3, :3])) for error in errors]) / lengths
    return RelativeError(float(np.sqrt(np.mean(shifts**2))), float(np.sqrt(np.mean(turns**2))), len(starts))
