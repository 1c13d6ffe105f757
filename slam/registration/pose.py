"""Pose of a camera from known points, refined over reprojection and inverse depth.

A residual has up to three parts: pixel x, pixel y (in units of ``SIGMA_PX``) and, where the depth camera answered,
inverse depth (in units of ``SIGMA_INVERSE_DEPTH``: the error of a structured-light camera is constant in
disparity, Khoshelham and Elberink 2012). Poses are (4, 4) ``T_cam_ref``; tangents are translation first and act from
the left.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.geometry import Pose, normalized

SIGMA_PX = 1.0
SIGMA_INVERSE_DEPTH = 0.008
#: 95 % quantiles of chi-squared with 2 and 3 degrees of freedom.
CHI2_PIXEL = 5.99
CHI2_DEPTH = 7.81
#: chi-squared of a point behind the camera, so that no step gains by pushing points there.
_BEHIND = 1e4
#: Descent ends where a step lowers the cost by less than this share: a fiftieth of a pose's sigma ...
_LEAST_GAIN = 1e-6
#: ... and a fifth of it where only outliers are looked for.
_COARSE_GAIN = 1e-4

Array = NDArray[np.float64]


def refine_pose(
    T_cam_ref: Pose, points_ref: Array, pixels: Array, inverse_depth: Array, intrinsics: Array, *, rounds: int = 3
) -> tuple[Pose, NDArray[np.bool_]]:
    """Robust Levenberg-Marquardt (Cauchy kernel, then outliers left out) from a first guess.

    Args:
        T_cam_ref: (4, 4) first guess.
        points_ref: (N, 3) points in the reference frame, metres.
        pixels: (N, 2) where they were seen.
        inverse_depth: (N,) measured 1 / z in 1 / metres, NaN where unknown.
        intrinsics: (4,) fx fy cx cy.
        rounds: how often outliers are chosen anew.

    Returns:
        The pose and the inliers (N,).
    """
    T, inliers = _refine(
        T_cam_ref[:3, :3].copy(), T_cam_ref[:3, 3].copy(), points_ref, pixels, inverse_depth, intrinsics, rounds
    )
    return normalized(T), inliers


@njit(cache=True, nogil=True)
def residual(
    R: Array, t: Array, point: Array, u: float, v: float, w: float, intrinsics: Array, r: Array, p: Array
) -> float:
    """Fills the residual ``r`` (3,) and the point in the camera ``p`` (3,); returns chi2, -1 behind the camera."""
    for i in range(3):
        p[i] = R[i, 0] * point[0] + R[i, 1] * point[1] + R[i, 2] * point[2] + t[i]
    if p[2] <= 0.05:
        return -1.0
    r[0] = (u - (intrinsics[0] * p[0] / p[2] + intrinsics[2])) / SIGMA_PX
    r[1] = (v - (intrinsics[1] * p[1] / p[2] + intrinsics[3])) / SIGMA_PX
    r[2] = 0.0 if np.isnan(w) else (w - 1.0 / p[2]) / SIGMA_INVERSE_DEPTH
    chi2: float = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    return chi2


@njit(cache=True, nogil=True)
def jacobian(p: Array, has_depth: bool, intrinsics: Array, J: Array) -> None:
    """Fills J (3, 3), the derivative of the predicted measurement by the point in the camera frame."""
    z = 1.0 / p[2]
    J[0, 0] = intrinsics[0] * z / SIGMA_PX
    J[0, 1] = 0.0
    J[0, 2] = -intrinsics[0] * p[0] * z * z / SIGMA_PX
    J[1, 0] = 0.0
    J[1, 1] = intrinsics[1] * z / SIGMA_PX
    J[1, 2] = -intrinsics[1] * p[1] * z * z / SIGMA_PX
    J[2, 0] = 0.0
    J[2, 1] = 0.0
    J[2, 2] = -z * z / SIGMA_INVERSE_DEPTH if has_depth else 0.0


@njit(cache=True, nogil=True)
def pose_jacobian(J: Array, p: Array, G: Array) -> None:
    """Fills G (3, 6) = J [I | -hat(p)], the derivative by the pose's tangent."""
    for i in range(3):
        G[i, 0], G[i, 1], G[i, 2] = J[i, 0], J[i, 1], J[i, 2]
        G[i, 3] = J[i, 2] * p[1] - J[i, 1] * p[2]
        G[i, 4] = J[i, 0] * p[2] - J[i, 2] * p[0]
        G[i, 5] = J[i, 1] * p[0] - J[i, 0] * p[1]


@njit(cache=True, nogil=True)
def point_jacobian(J: Array, R: Array, F: Array) -> None:
    """Fills F (3, 3) = J R, the derivative by the point in the reference frame."""
    for i in range(3):
        for k in range(3):
            F[i, k] = J[i, 0] * R[0, k] + J[i, 1] * R[1, k] + J[i, 2] * R[2, k]


@njit(cache=True, nogil=True)
def invert3(M: Array, out: Array) -> None:
    """Inverse of a symmetric positive (3, 3) matrix by cofactors."""
    a, b, c, d, e, f = M[0, 0], M[0, 1], M[0, 2], M[1, 1], M[1, 2], M[2, 2]
    c00, c01, c02 = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * c00 + b * c01 + c * c02
    out[0, 0], out[0, 1], out[0, 2] = c00 / det, c01 / det, c02 / det
    out[1, 0], out[1, 1], out[1, 2] = c01 / det, (a * f - c * c) / det, (b * c - a * e) / det
    out[2, 0], out[2, 1], out[2, 2] = c02 / det, (b * c - a * e) / det, (a * d - b * b) / det


@njit(cache=True, nogil=True)
def apply_tangent(R: Array, t: Array, tangent: Array) -> None:
    """(R, t) <- exp(tangent) (R, t), in place."""
    wx, wy, wz = tangent[3], tangent[4], tangent[5]
    angle = np.sqrt(wx * wx + wy * wy + wz * wz)
    K = np.array([[0.0, -wz, wy], [wz, 0.0, -wx], [-wy, wx, 0.0]])
    KK = K @ K
    if angle < 1e-8:
        a, b, c = 1.0, 0.5, 1.0 / 6.0
    else:
        a = np.sin(angle) / angle
        b = (1.0 - np.cos(angle)) / angle**2
        c = (1.0 - a) / angle**2
    E = np.eye(3) + a * K + b * KK
    V = np.eye(3) + b * K + c * KK
    R[:, :] = E @ R
    t[:] = E @ t + V @ tangent[:3]


@njit(cache=True, nogil=True)
def limit(w: float) -> float:
    """The chi2 that an inlier has at most, with or without depth."""
    return CHI2_PIXEL if np.isnan(w) else CHI2_DEPTH


@njit(cache=True, nogil=True)
def _linearised(
    R: Array,
    t: Array,
    points: Array,
    pixels: Array,
    inverse_depth: Array,
    intrinsics: Array,
    used: NDArray[np.bool_],
    H: Array,
    b: Array,
) -> float:
    """Sum of the Cauchy costs of the used points (far outliers hardly pull), with their equations H (6, 6) and b (6,).

    One pass gives both, as nearly every step is taken. Of the symmetric H the lower part is summed up.
    """
    H[:, :] = 0.0
    b[:] = 0.0
    r, p, J, G = np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((3, 6))
    total = 0.0
    for i in range(len(points)):
        if not used[i]:
            continue
        w = inverse_depth[i]
        chi2, far = residual(R, t, points[i], pixels[i, 0], pixels[i, 1], w, intrinsics, r, p), limit(w)
        if chi2 < 0.0:
            total += far * np.log(1.0 + _BEHIND / far)
            continue
        total += far * np.log(1.0 + chi2 / far)
        jacobian(p, not np.isnan(w), intrinsics, J)
        pose_jacobian(J, p, G)
        weight = 1.0 / (1.0 + chi2 / far)
        for a in range(6):
            g0, g1, g2 = weight * G[0, a], weight * G[1, a], weight * G[2, a]
            b[a] += g0 * r[0] + g1 * r[1] + g2 * r[2]
            for c in range(a + 1):
                H[a, c] += g0 * G[0, c] + g1 * G[1, c] + g2 * G[2, c]
    for a in range(6):
        for c in range(a):
            H[c, a] = H[a, c]
    return total


@njit(cache=True, nogil=True)
def _descend(
    R: Array,
    t: Array,
    points: Array,
    pixels: Array,
    inverse_depth: Array,
    intrinsics: Array,
    used: NDArray[np.bool_],
    least_gain: float,
) -> tuple[Array, Array]:
    """Levenberg-Marquardt until a step gains less than this share of the cost; steps uphill are taken back."""
    H, b, new_H, new_b = np.zeros((6, 6)), np.zeros(6), np.zeros((6, 6)), np.zeros(6)
    cost = _linearised(R, t, points, pixels, inverse_depth, intrinsics, used, H, b)
    damping = 1e-6
    for _ in range(15):
        damped: Array = H.copy()
        for a in range(6):
            damped[a, a] += damping * H[a, a] + 1e-6
        step: Any = np.linalg.solve(damped, b)
        new_R, new_t = R.copy(), t.copy()
        apply_tangent(new_R, new_t, step)
        new_cost = _linearised(new_R, new_t, points, pixels, inverse_depth, intrinsics, used, new_H, new_b)
        if new_cost < cost:
            done = cost - new_cost < least_gain * cost
            R, t, cost = new_R, new_t, new_cost
            H, new_H, b, new_b = new_H, H, new_b, b
            damping = max(1e-9, damping * 0.1)
            if done:
                break
        else:
            damping = max(1e-4, damping * 10.0)
            if np.sqrt(np.sum(step * step)) < 1e-9:
                break
    return R, t


@njit(cache=True, nogil=True)
def _refine(
    R: Array, t: Array, points: Array, pixels: Array, inverse_depth: Array, intrinsics: Array, rounds: int
) -> tuple[Array, NDArray[np.bool_]]:
    inliers = np.ones(len(points), np.bool_)
    r, p = np.zeros(3), np.zeros(3)
    for k in range(rounds):
        least_gain = _LEAST_GAIN if k == rounds - 1 else _COARSE_GAIN
        R, t = _descend(R, t, points, pixels, inverse_depth, intrinsics, inliers, least_gain)
        for i in range(len(points)):
            w = inverse_depth[i]
            chi2 = residual(R, t, points[i], pixels[i, 0], pixels[i, 1], w, intrinsics, r, p)
            inliers[i] = chi2 >= 0.0 and chi2 <= limit(w)
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = t
    return T, inliers
