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
    height, width = face.shape
    face[:] = -1
    inverse_z[:] = 0.0
    fx, fy, cx, cy = K[0, 0], K[1, 1], K[0, 2], K[1, 2]
    px, py = np.empty(8), np.empty(8)
    for f in range(len(corners_cam)):
        corners = corners_cam[f]
        normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
        distance = normal[0] * corners[0, 0] + normal[1] * corners[0, 1] + normal[2] * corners[0, 2]
        if distance <= 0.0:
            continue
        count = 0
        for i in range(4):
            a, b = corners[i], corners[(i + 1) % 4]
            if a[2] >= NEAR_M:
                px[count], py[count] = fx * a[0] / a[2] + cx, fy * a[1] / a[2] + cy
                count += 1
            if (a[2] >= NEAR_M) != (b[2] >= NEAR_M):
                t = (NEAR_M - a[2]) / (b[2] - a[2])
                px[count] = fx * (a[0] + t * (b[0] - a[0])) / NEAR_M + cx
                py[count] = fy * (a[1] + t * (b[1] - a[1])) / NEAR_M + cy
                count += 1
        if count < 3:
            continue
        slope_x, slope_y = normal[0] / (distance * fx), normal[1] / (distance * fy)
        offset = normal[2] / distance - slope_x * cx - slope_y * cy
        first = max(0, int(np.ceil(py[:count].min())))
        last = min(height - 1, int(np.floor(py[:count].max())))
        for y in range(first, last + 1):
            left, right = np.inf, -np.inf
            for i in range(count):
                j = (i + 1) % count
                if (py[i] <= y) != (py[j] <= y):
                    x = px[i] + (y - py[i]) / (py[j] - py[i]) * (px[j] - px[i])
                    left, right = min(left, x), max(right, x)
            # A hair wider than the face, so that no crack opens between neighbours.
            for x in range(max(0, int(np.ceil(left - 1e-6))), min(width - 1, int(np.floor(right + 1e-6))) + 1):
                value = slope_x * x + slope_y * y + offset
                if value > inverse_z[y, x]:
                    inverse_z[y, x] = value
                    face[y, x] = f
