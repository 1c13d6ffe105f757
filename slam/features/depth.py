"""Depth of key points, and their 3D points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.region import Wanted
from slam.geometry import transform

#: A depth is trusted when its 3x3 neighbourhood spreads less than this share of it.
_FLAT = 0.05


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


def _sample(depth_m: NDArray[np.float32], pixels: NDArray[np.floating]) -> NDArray[np.float64]:
    """Depth (N,) at or next to each pixel; 0 where it is unknown or changes too fast to be trusted."""
    height, width = depth_m.shape
    x = np.clip(np.rint(pixels[:, 0]).astype(np.int32), 1, width - 2)
    y = np.clip(np.rint(pixels[:, 1]).astype(np.int32), 1, height - 2)
    patch = np.stack([depth_m[y + dy, x + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)])
    patch[patch <= 0] = np.nan
    known = np.isfinite(patch).sum(axis=0)
    patch[:, known == 0] = 0.0
    middle = np.where(np.isfinite(patch[4]), patch[4], np.nanmedian(patch, axis=0))
    flat = np.nanmax(patch, axis=0) - np.nanmin(patch, axis=0) <= _FLAT * middle
    return np.where(flat & (known > 0), middle, 0.0).astype(np.float64)
