"""Depth of key points, and their 3D points."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.region import Wanted
from slam.geometry import transform

#: A depth is trusted when its 3x3 neighbourhood spreads less than this share of it.
_FLAT = np.float32(0.05)


def points_base(
    pixels: NDArray[np.floating], depth_m: NDArray[np.float32], camera: Camera, wanted: Wanted
) -> NDArray[np.float32]:
    """(N, 3) points in the base frame; NaN where depth is unknown, out of range, or on the edge of something."""
    points_cam = camera.unproject(pixels, depth_at(depth_m, pixels, wanted))
    return transform(camera.T_base_cam, points_cam).astype(np.float32)


def depth_at(depth_m: NDArray[np.float32], pixels: NDArray[np.floating], wanted: Wanted) -> NDArray[np.float64]:
    """Depth (N,) metres at or next to each pixel (N, 2); NaN where ``points_base`` has none."""
    depth = _sample(depth_m, pixels)
    good = depth > max(0.0, wanted.MinDepth)
    if wanted.MaxDepth > 0:
        good &= depth <= wanted.MaxDepth
    return np.where(good, depth, np.nan)


@njit(cache=True, nogil=True)
def _sample(depth_m: NDArray[np.float32], pixels: NDArray[np.floating]) -> NDArray[np.float64]:
    """Depth (N,) at or next to each pixel; 0 where it is unknown or changes too fast to be trusted."""
    height, width = depth_m.shape
    found = np.zeros(len(pixels))
    known = np.empty(9, np.float32)
    for i in range(len(pixels)):
        x = min(max(int(np.rint(pixels[i, 0])), 1), width - 2)
        y = min(max(int(np.rint(pixels[i, 1])), 1), height - 2)
        count = 0
        for v in range(y - 1, y + 2):
            for u in range(x - 1, x + 2):
                if depth_m[v, u] > 0:
                    known[count] = depth_m[v, u]
                    count += 1
        if count == 0:
            continue
        patch = known[:count]
        middle = depth_m[y, x] if depth_m[y, x] > 0 else np.float32(np.median(patch))
        if patch.max() - patch.min() <= _FLAT * middle:
            found[i] = middle
    return found
