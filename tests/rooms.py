"""Depth images of a simple room for tests: floor, walls, a table, and where wanted a ramp, rendered by ray casting."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Array, Pose, make, so3_exp

CAMERA = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
#: Height of the camera over the floor, metres.
HEIGHT = 1.0
TABLE = ((1.5, 2.3), (-0.4, 0.4), -0.3)


def tilted(roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> Pose:
    """Rotation ``T_map_base`` from roll, pitch and yaw in radians."""
    turns = [so3_exp(np.array(v)) for v in ((0, 0, yaw), (0, pitch, 0), (roll, 0, 0))]
    return make(np.asarray(turns[0] @ turns[1] @ turns[2]), np.zeros(3))


def render(T_map_base: Pose, *, wall: float = 4.0, table: bool = False, ceiling: float = np.inf) -> NDArray[np.float32]:
    """Depth (480, 640) from the middle of a room with walls at ``wall`` metres and the floor ``HEIGHT`` below."""
    rays = _rays() @ (T_map_base[:3, :3] @ CAMERA.T_base_cam[:3, :3]).T
    surfaces = [_plane(rays, 2, -HEIGHT), _plane(rays, 2, ceiling)]
    surfaces += [_plane(rays, axis, side * wall) for axis in (0, 1) for side in (-1, 1)]
    if table:
        (x0, x1), (y0, y1), z = TABLE
        top = _plane(rays, 2, z)
        hit = rays * np.where(np.isfinite(top), top, 0)[..., None]
        inside = (hit[..., 0] > x0) & (hit[..., 0] < x1) & (hit[..., 1] > y0) & (hit[..., 1] < y1)
        surfaces.append(np.where(inside, top, np.inf))
    return np.asarray(np.min(surfaces, axis=0), dtype=np.float32)


def _rays() -> Array:
    u, v = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    return np.stack([(u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy, np.ones_like(u, dtype=float)], axis=-1)


def _plane(rays: Array, axis: int, at: float) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = at / rays[..., axis]
    return np.where(np.isfinite(depth) & (depth > 0), depth, np.inf)
