"""Which face each pixel sees, and how far away: exact, by a depth buffer over planar faces."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: Nothing is drawn nearer than this, in metres.
NEAR_M = 0.05


@njit(cache=True, nogil=True)
def visible(
    corners_cam: NDArray[np.float64], K: NDArray[np.float64], face: NDArray[np.int32], inverse_z: NDArray[np.float64]
) -> None:
    """Fill ``face`` (H, W; -1 for none) and ``inverse_z`` (H, W; 1/m at pixel centres) from faces (F, 4, 3).

    A face's corners are top left, top right, bottom right, bottom left as seen from its front; its back is not drawn.
    1/z of a plane is linear in the image, so that depth needs no ray.
    """
    face[:] = -1
    inverse_z[:] = 0.0
    outline = np.empty((8, 2))
    for f in range(len(corners_cam)):
        corners = corners_cam[f]
        normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
        distance = normal[0] * corners[0, 0] + normal[1] * corners[0, 1] + normal[2] * corners[0, 2]
        if distance > 0.0:
            count = _project(corners, K, outline)
            if count >= 3:
                slope_x, slope_y = normal[0] / (distance * K[0, 0]), normal[1] / (distance * K[1, 1])
                offset = normal[2] / distance - slope_x * K[0, 2] - slope_y * K[1, 2]
                _fill(outline[:count], slope_x, slope_y, offset, f, face, inverse_z)


@njit(cache=True, nogil=True)
def _project(corners: NDArray[np.float64], K: NDArray[np.float64], outline: NDArray[np.float64]) -> int:
    """Corners of a face in the image, cut off at the near plane; returns how many."""
    count = 0
    for i in range(4):
        a, b = corners[i], corners[(i + 1) % 4]
        if a[2] >= NEAR_M:
            outline[count, 0] = K[0, 0] * a[0] / a[2] + K[0, 2]
            outline[count, 1] = K[1, 1] * a[1] / a[2] + K[1, 2]
            count += 1
        if (a[2] >= NEAR_M) != (b[2] >= NEAR_M):
            t = (NEAR_M - a[2]) / (b[2] - a[2])
            outline[count, 0] = K[0, 0] * (a[0] + t * (b[0] - a[0])) / NEAR_M + K[0, 2]
            outline[count, 1] = K[1, 1] * (a[1] + t * (b[1] - a[1])) / NEAR_M + K[1, 2]
            count += 1
    return count


@njit(cache=True, nogil=True)
def _fill(
    outline: NDArray[np.float64],
    slope_x: float,
    slope_y: float,
    offset: float,
    f: int,
    face: NDArray[np.int32],
    inverse_z: NDArray[np.float64],
) -> None:
    """Draw a convex outline (N, 2) where its plane, 1/z = slopes . (x, y) + offset, is nearer than what is there."""
    height, width = face.shape
    first = max(0, int(np.ceil(outline[:, 1].min())))
    last = min(height - 1, int(np.floor(outline[:, 1].max())))
    for y in range(first, last + 1):
        left, right = np.inf, -np.inf
        for i in range(len(outline)):
            x0, y0 = outline[i]
            x1, y1 = outline[(i + 1) % len(outline)]
            if (y0 <= y) != (y1 <= y):
                x = x0 + (y - y0) / (y1 - y0) * (x1 - x0)
                left, right = min(left, x), max(right, x)
        # A hair wider than the face, so that no crack opens between neighbours.
        for x in range(max(0, int(np.ceil(left - 1e-6))), min(width - 1, int(np.floor(right + 1e-6))) + 1):
            value = slope_x * x + slope_y * y + offset
            if value > inverse_z[y, x]:
                inverse_z[y, x] = value
                face[y, x] = f
