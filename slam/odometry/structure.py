"""Local bundle adjustment of the structure: points move to where all key frames together saw them, poses are held.

A pose that has been told is part of the path: were it moved later, the next one would jump. With the poses held, the
normal equations fall apart into one (3, 3) block a point (Triggs et al. 2000, section 6), and what earlier key frames
said of a point is its information matrix: nothing else needs to be kept of them.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.registration.pose import invert3, jacobian, limit, point_jacobian, pose_jacobian, residual

Array = NDArray[np.float64]
#: The first step is nearly exact, as the points have depth; the second one sees the weight of where it led.
_STEPS = 2
#: Keeps blocks of points without depth regular, 1 / metres^2.
_LEAST_INFORMATION = 1e-6


@njit(cache=True, nogil=True)
def adjust_points(
    points: Array,
    information: Array,
    looks: NDArray[np.int64],
    rows: NDArray[np.int64],
    T_cam_ref: Array,
    pose_variances: tuple[float, float],
    pixels: Array,
    inverse_depths: Array,
    intrinsics: Array,
    remembered: int,
) -> None:
    """Takes one key frame into the points that it saw, in place.

    The first look at a point weighs, but does not move it: it is where that look put it. A look that is somewhat off
    counts for less (Cauchy kernel), one that is no inlier for nothing; and each look is as uncertain as the pose that
    it was taken from makes it.

    Args:
        points: (N, 3) in the reference frame, metres.
        information: (N, 3, 3) of the points, 1 / metres^2.
        looks: (N,) key frames that each point was adjusted to.
        rows: (M,) points that the key frame saw, each once.
        T_cam_ref: (4, 4) pose of the key frame.
        pose_variances: of the pose, along and about each axis, metres^2 and radians^2.
        pixels: (M, 2) where it saw them.
        inverse_depths: (M,) 1 / metres, NaN where unknown.
        intrinsics: (4,) fx fy cx cy.
        remembered: a point weighs no more than so many looks; older ones fade.
    """
    R, t = T_cam_ref[:3, :3].copy(), T_cam_ref[:3, 3].copy()
    r, p, b = np.zeros(3), np.zeros(3), np.zeros(3)
    J, F, WF, A, inverse = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    for k in range(len(rows)):
        row, w = rows[k], inverse_depths[k]
        fading = min(1.0, (remembered - 1.0) / max(1.0, float(looks[row])))
        x = points[row].copy()
        seen = False
        for _ in range(_STEPS):
            chi2 = residual(R, t, x, pixels[k, 0], pixels[k, 1], w, intrinsics, r, p)
            if chi2 < 0.0 or chi2 > limit(w):
                break
            seen = True
            jacobian(p, not np.isnan(w), intrinsics, J)
            point_jacobian(J, R, F)
            _weigh(J, F, p, pose_variances, 1.0 / (1.0 + chi2 / limit(w)), WF)
            for a in range(3):
                b[a] = 0.0
                for c in range(3):
                    before = fading * information[row, a, c]
                    A[a, c] = before + WF[0, a] * F[0, c] + WF[1, a] * F[1, c] + WF[2, a] * F[2, c]
                    b[a] += WF[c, a] * r[c] - before * (x[c] - points[row, c])
                A[a, a] += _LEAST_INFORMATION
            if looks[row] == 0:
                break
            invert3(A, inverse)
            for a in range(3):
                x[a] += inverse[a, 0] * b[0] + inverse[a, 1] * b[1] + inverse[a, 2] * b[2]
        if seen:
            points[row], information[row] = x, A
            looks[row] = min(looks[row] + 1, remembered)


@njit(cache=True, nogil=True)
def _weigh(J: Array, F: Array, p: Array, pose_variances: tuple[float, float], weight: float, out: Array) -> None:
    """Fills ``out`` (3, 3) = weight (I + G S G')^-1 F: residuals have the sigma 1, and what the pose's errors add."""
    G, noise, inverse = np.zeros((3, 6)), np.eye(3), np.zeros((3, 3))
    pose_jacobian(J, p, G)
    for a in range(3):
        for c in range(3):
            for k in range(3):
                noise[a, c] += pose_variances[0] * G[a, k] * G[c, k] + pose_variances[1] * G[a, k + 3] * G[c, k + 3]
    invert3(noise, inverse)
    for a in range(3):
        for c in range(3):
            out[a, c] = weight * (inverse[a, 0] * F[0, c] + inverse[a, 1] * F[1, c] + inverse[a, 2] * F[2, c])
