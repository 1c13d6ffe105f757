"""The loop of ICP: pair each point with its nearest, step, again; compiled by numba at first use."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.registration.cells import Cells, nearest
from slam.registration.pose import apply_tangent

Array = NDArray[np.float64]
_FEWEST = 6
#: A step shorter than this (metres and radians) is far below what points of a depth camera tell.
_STILL = 1e-4
_DAMPING = 1e-7


@njit(cache=True, nogil=True)
def align(
    cells: Cells,
    normals: Array,
    points: Array,
    T_from_to: Pose,
    radius: float,
    kept: float,
    free: NDArray[np.bool_],
    iterations: int,
    epsilon: float,
) -> Pose:
    """Gauss-Newton over point pairs that are chosen anew at each step (Besl and McKay 1992, Chen and Medioni 1992).

    Args:
        cells: the points of the first scan.
        normals: (N, 3) their unit normals; (0, 3) to minimise distances to points instead of planes.
        points: (M, 3) of the second scan, in its own frame.
        T_from_to: (4, 4) first guess.
        radius: largest distance of a pair, metres; at most the cells' size.
        kept: share of the pairs, the nearest ones, that counts (trimmed ICP, Chetverikov et al. 2002).
        free: (6,) which of x y z roll pitch yaw may change.
        iterations: at most so many steps.
        epsilon: stops at a step below this, metres and radians.
    """
    R, t = T_from_to[:3, :3].copy(), T_from_to[:3, 3].copy()
    axes = np.flatnonzero(free)
    for _ in range(iterations):
        moved = points @ R.T + t
        rows, squared = nearest(cells, moved, radius)
        paired = np.flatnonzero(rows >= 0)
        if len(paired) < _FEWEST:
            break
        farthest = np.sort(squared[paired])[int(kept * (len(paired) - 1))]
        H, b = _normal_equations(cells.points, normals, moved, rows, squared, farthest)
        small, right = np.zeros((len(axes), len(axes))), np.zeros(len(axes))
        for a in range(len(axes)):
            right[a] = b[axes[a]]
            for c in range(len(axes)):
                small[a, c] = H[axes[a], axes[c]]
        for a in range(len(axes)):
            small[a, a] += _DAMPING * len(paired)
        step = np.zeros(6)
        step[axes] = np.linalg.solve(small, right)
        apply_tangent(R, t, step)
        if np.max(np.abs(step)) < max(epsilon, _STILL):
            break
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = t
    return T


@njit(cache=True, nogil=True)
def _normal_equations(
    targets: Array, normals: Array, moved: Array, rows: NDArray[np.int64], squared: Array, farthest: float
) -> tuple[Array, Array]:
    """(6, 6) and (6,) of the pairs that are at most ``farthest`` (squared) apart."""
    H, b = np.zeros((6, 6)), np.zeros(6)
    J, gap = np.zeros((3, 6)), np.zeros(3)
    lines = 1 if len(normals) else 3
    for i in range(len(moved)):
        if rows[i] < 0 or squared[i] > farthest:
            continue
        x, y, z = moved[i, 0], moved[i, 1], moved[i, 2]
        for a in range(3):
            gap[a] = targets[rows[i], a] - moved[i, a]
        if lines == 1:
            u, v, w = normals[rows[i], 0], normals[rows[i], 1], normals[rows[i], 2]
            J[0, 0], J[0, 1], J[0, 2] = u, v, w
            J[0, 3], J[0, 4], J[0, 5] = y * w - z * v, z * u - x * w, x * v - y * u
            gap[0] = u * gap[0] + v * gap[1] + w * gap[2]
        else:
            J[0, 0], J[0, 4], J[0, 5] = 1.0, z, -y
            J[1, 1], J[1, 3], J[1, 5] = 1.0, -z, x
            J[2, 2], J[2, 3], J[2, 4] = 1.0, y, -x
        for k in range(lines):
            for a in range(6):
                b[a] += J[k, a] * gap[k]
                for c in range(6):
                    H[a, c] += J[k, a] * J[k, c]
    return H, b
