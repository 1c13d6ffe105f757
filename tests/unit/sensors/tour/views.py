"""Do two frames of a source agree, by their truth, depth and intrinsics?"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from slam.geometry import inverse, transform
from slam.types import Frame


@dataclass(frozen=True)
class Agreement:
    """Mean difference of colour (grey levels), median relative difference of depth, share of pixels in both."""

    grey: float
    depth: float
    overlap: float


def agreement(a: Frame, b: Frame, depth_scale: float = 1.0) -> Agreement:
    """Take the pixels of a with depth into b by ground truth and compare."""
    assert a.T_world_base is not None
    assert b.T_world_base is not None
    height, width = a.depth_m.shape
    v, u = (axis.ravel() for axis in np.mgrid[2 : height - 2 : 4, 2 : width - 2 : 4])
    known = a.depth_m[v, u] > 0
    u, v = u[known], v[known]
    points = a.camera.unproject(np.column_stack([u, v]), depth_scale * a.depth_m[v, u])
    T_b_a = inverse(b.T_world_base @ b.camera.T_base_cam) @ a.T_world_base @ a.camera.T_base_cam
    points_b = transform(T_b_a, points)
    pixels = b.camera.project(points_b).astype(np.float32)
    x, y = np.nan_to_num(np.rint(pixels), nan=-1).astype(int).T
    inside = (x > 1) & (y > 1) & (x < width - 2) & (y < height - 2)
    z, z_b = points_b[inside, 2], b.depth_m[y[inside], x[inside]]
    error = np.abs(z_b - z) / z
    seen = (z_b > 0) & (error < 0.1)
    grey_a, grey_b = (
        cv2.GaussianBlur(cv2.cvtColor(f.image_bgr, cv2.COLOR_BGR2GRAY), (0, 0), 1).astype(np.float32) for f in (a, b)
    )
    there = cv2.remap(grey_b, pixels[inside][:, :1], pixels[inside][:, 1:], cv2.INTER_LINEAR).ravel()
    grey = np.abs(there - grey_a[v[inside], u[inside]])[seen].mean()
    return Agreement(float(grey), float(np.median(error[z_b > 0])), float(inside.mean()))
