"""Bundle adjustment: poses and points together, by Levenberg-Marquardt with a Schur complement.

The points are eliminated from the normal equations, so that only six unknowns a key frame are solved densely
(Triggs et al. 2000, section 6.1).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.registration.pose import (
    CHI2_DEPTH,
    apply_tangent,
    invert3,
    jacobian,
    limit,
    point_jacobian,
    pose_jacobian,
    residual,
)

Array = NDArray[np.float64]
_HUBER2 = CHI2_DEPTH


@njit(cache=True, nogil=True)
def adjust(
    poses: Array,
    points: Array,
    obs_pose: NDArray[np.int32],
    obs_point: NDArray[np.int32],
    obs_pixel: Array,
    obs_inverse_depth: Array,
    intrinsics: Array,
    fixed: int,
    iterations: int,
) -> tuple[Array, Array, NDArray[np.bool_], float, float]:
    """Minimises the robust reprojection and inverse-depth error.

    Args:
        poses: (K, 4, 4) T_cam_ref of the key frames.
        points: (P, 3) points in the reference frame, metres.
        obs_pose: (O,) key frame of each observation.
        obs_point: (O,) point of each observation, in ascending order.
        obs_pixel: (O, 2) pixels.
        obs_inverse_depth: (O,) 1 / metres, NaN where unknown.
        intrinsics: (4,) fx fy cx cy.
        fixed: the first ``fixed`` poses are held.
        iterations: at most so many steps.

    Returns:
        Poses, points, inliers (O,), robust cost before and after.
    """
    K, P = len(poses), len(points)
    poses, points = poses.copy(), points.copy()
    damping = 1e-4
    cost = total_cost(poses, points, obs_pose, obs_point, obs_pixel, obs_inverse_depth, intrinsics)
    before = cost
    for _ in range(iterations):
        A, bp, C, bc, W = _normal_equations(
            poses, points, obs_pose, obs_point, obs_pixel, obs_inverse_depth, intrinsics
        )
        improved = False
        for _attempt in range(4):
            step_pose, step_point = _solve(A, bp, C, bc, W, obs_pose, obs_point, fixed, damping, K, P)
            new_poses, new_points = poses.copy(), points + step_point
            for k in range(fixed, K):
                R, t = new_poses[k, :3, :3].copy(), new_poses[k, :3, 3].copy()
                apply_tangent(R, t, step_pose[k])
                new_poses[k, :3, :3] = R
                new_poses[k, :3, 3] = t
            new_cost = total_cost(new_poses, new_points, obs_pose, obs_point, obs_pixel, obs_inverse_depth, intrinsics)
            if new_cost < cost:
                improved = True
                break
            damping *= 10.0
        if not improved:
            break
        gain = cost - new_cost
        poses, points, cost = new_poses, new_points, new_cost
        damping = max(1e-7, damping * 0.2)
        if gain < 1e-4 * cost:
            break
    inliers = _inliers(poses, points, obs_pose, obs_point, obs_pixel, obs_inverse_depth, intrinsics)
    return poses, points, inliers, before, cost


@njit(cache=True, nogil=True)
def total_cost(
    poses: Array,
    points: Array,
    obs_pose: NDArray[np.int32],
    obs_point: NDArray[np.int32],
    obs_pixel: Array,
    obs_inverse_depth: Array,
    intrinsics: Array,
) -> float:
    """Sum of Huber costs of all observations; a point behind a camera costs as much as a far outlier."""
    r, p = np.zeros(3), np.zeros(3)
    total = 0.0
    for o in range(len(obs_pose)):
        T = poses[obs_pose[o]]
        chi2 = residual(
            T[:3, :3],
            T[:3, 3],
            points[obs_point[o]],
            obs_pixel[o, 0],
            obs_pixel[o, 1],
            obs_inverse_depth[o],
            intrinsics,
            r,
            p,
        )
        if chi2 < 0.0:
            chi2 = 1e4
        total += chi2 if chi2 <= _HUBER2 else 2.0 * np.sqrt(_HUBER2 * chi2) - _HUBER2
    return total


@njit(cache=True, nogil=True)
def _normal_equations(
    poses: Array,
    points: Array,
    obs_pose: NDArray[np.int32],
    obs_point: NDArray[np.int32],
    obs_pixel: Array,
    obs_inverse_depth: Array,
    intrinsics: Array,
) -> tuple[Array, Array, Array, Array, Array]:
    """Blocks of J^T J and J^T r: poses A (K, 6, 6), bp; points C (P, 3, 3), bc; and W (O, 6, 3) between them."""
    A, bp = np.zeros((len(poses), 6, 6)), np.zeros((len(poses), 6))
    C, bc = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    W = np.zeros((len(obs_pose), 6, 3))
    r, p, J, G, F = np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((3, 6)), np.zeros((3, 3))
    for o in range(len(obs_pose)):
        k, j = obs_pose[o], obs_point[o]
        R = poses[k, :3, :3]
        w = obs_inverse_depth[o]
        chi2 = residual(R, poses[k, :3, 3], points[j], obs_pixel[o, 0], obs_pixel[o, 1], w, intrinsics, r, p)
        if chi2 < 0.0:
            continue
        weight = 1.0 if chi2 <= _HUBER2 else np.sqrt(_HUBER2 / chi2)
        jacobian(p, not np.isnan(w), intrinsics, J)
        pose_jacobian(J, p, G)
        point_jacobian(J, R, F)
        for a in range(6):
            for m in range(3):
                bp[k, a] += weight * G[m, a] * r[m]
            for c in range(6):
                A[k, a, c] += weight * (G[0, a] * G[0, c] + G[1, a] * G[1, c] + G[2, a] * G[2, c])
            for c in range(3):
                W[o, a, c] = weight * (G[0, a] * F[0, c] + G[1, a] * F[1, c] + G[2, a] * F[2, c])
        for a in range(3):
            for m in range(3):
                bc[j, a] += weight * F[m, a] * r[m]
            for c in range(3):
                C[j, a, c] += weight * (F[0, a] * F[0, c] + F[1, a] * F[1, c] + F[2, a] * F[2, c])
    return A, bp, C, bc, W


@njit(cache=True, nogil=True)
def _solve(
    A: Array,
    bp: Array,
    C: Array,
    bc: Array,
    W: Array,
    obs_pose: NDArray[np.int32],
    obs_point: NDArray[np.int32],
    fixed: int,
    damping: float,
    K: int,
    P: int,
) -> tuple[Array, Array]:
    """Steps of the poses (K, 6) and points (P, 3); observations must be grouped by point."""
    size = 6 * K
    S, g = np.zeros((size, size)), np.zeros(size)
    inverses, damped, WC = np.zeros((P, 3, 3)), np.zeros((3, 3)), np.zeros((6, 3))
    for k in range(K):
        S[6 * k : 6 * k + 6, 6 * k : 6 * k + 6] = A[k]
        for a in range(6):
            S[6 * k + a, 6 * k + a] += damping * (A[k, a, a] + 1e-3)
        g[6 * k : 6 * k + 6] = bp[k]
    start = 0
    count = len(obs_point)
    while start < count:
        j = obs_point[start]
        end = start
        while end < count and obs_point[end] == j:
            end += 1
        damped[:, :] = C[j]
        for a in range(3):
            damped[a, a] += damping * C[j, a, a] + 1e-6
        invert3(damped, inverses[j])
        for o in range(start, end):
            k = obs_pose[o]
            for a in range(6):
                for c in range(3):
                    WC[a, c] = (
                        W[o, a, 0] * inverses[j, 0, c] + W[o, a, 1] * inverses[j, 1, c] + W[o, a, 2] * inverses[j, 2, c]
                    )
                g[6 * k + a] -= WC[a, 0] * bc[j, 0] + WC[a, 1] * bc[j, 1] + WC[a, 2] * bc[j, 2]
            for q in range(start, end):
                m = obs_pose[q]
                for a in range(6):
                    for c in range(6):
                        S[6 * k + a, 6 * m + c] -= WC[a, 0] * W[q, c, 0] + WC[a, 1] * W[q, c, 1] + WC[a, 2] * W[q, c, 2]
        start = end
    step_pose = np.zeros((K, 6))
    free = 6 * fixed
    if fixed < K:
        solution = np.linalg.solve(S[free:, free:].copy(), g[free:].copy())
        for k in range(fixed, K):
            step_pose[k] = solution[6 * (k - fixed) : 6 * (k - fixed) + 6]
    rest = bc.copy()
    for o in range(count):
        k, j = obs_pose[o], obs_point[o]
        for c in range(3):
            for a in range(6):
                rest[j, c] -= W[o, a, c] * step_pose[k, a]
    step_point = np.zeros((P, 3))
    for j in range(P):
        for a in range(3):
            step_point[j, a] = (
                inverses[j, a, 0] * rest[j, 0] + inverses[j, a, 1] * rest[j, 1] + inverses[j, a, 2] * rest[j, 2]
            )
    return step_pose, step_point


@njit(cache=True, nogil=True)
def _inliers(
    poses: Array,
    points: Array,
    obs_pose: NDArray[np.int32],
    obs_point: NDArray[np.int32],
    obs_pixel: Array,
    obs_inverse_depth: Array,
    intrinsics: Array,
) -> NDArray[np.bool_]:
    r, p = np.zeros(3), np.zeros(3)
    inliers = np.zeros(len(obs_pose), np.bool_)
    for o in range(len(obs_pose)):
        T, w = poses[obs_pose[o]], obs_inverse_depth[o]
        chi2 = residual(
            T[:3, :3], T[:3, 3], points[obs_point[o]], obs_pixel[o, 0], obs_pixel[o, 1], w, intrinsics, r, p
        )
        inliers[o] = chi2 >= 0.0 and chi2 <= limit(w)
    return inliers
