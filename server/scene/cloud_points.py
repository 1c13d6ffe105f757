"""The points that one node adds to the view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose
from slam.maps.point_cloud import Colors, Points, node_cloud

#: Points of all clouds of an ordinary map, and of one cloud.
_ALL = 600_000
_LEAST, _MOST = 4_000, 12_000
#: Depth images are read at about this many columns.
_COLUMNS = 213
#: Beyond this a depth camera sees mostly noise.
_FAR_M = 6.0
#: Points this much higher than the camera are a ceiling to whoever looks down on the map.
_CEILING_M = 0.9
_LEAST_LEFT = 200
#: A step of depth, as a share of the depth, that no floor makes: points at such edges hang in the air.
_JUMP = 0.07
_FINEST_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class CloudPoints:
    """Points (N, 3) float32 in the base frame, their colours (N, 3) red first, and their distance in metres."""

    points: Points
    colours: Colors
    spacing: float


def points_of_each(clouds: int) -> int:
    """How many points each of so many clouds gets."""
    return int(np.clip(_ALL // max(1, clouds), _LEAST, _MOST))


def view_points(
    image_bgr: NDArray[np.uint8], depth_m: NDArray[np.float32], camera: Camera, T_map_base: Pose, most: int
) -> CloudPoints:
    """At most so many points of what a node saw, evenly spread; no ceiling, and nothing that hangs in the air."""
    step = max(1, round(depth_m.shape[1] / _COLUMNS))
    points, colours = node_cloud(image_bgr, _without_edges(depth_m, step), camera, step, _FAR_M)
    up_base = T_map_base[2, :3]
    above_camera = points @ up_base.astype(np.float32) - float(up_base @ camera.T_base_cam[:3, 3])
    below_ceiling = above_camera < _CEILING_M
    if below_ceiling.sum() >= _LEAST_LEFT:
        points, colours = points[below_ceiling], colours[below_ceiling]
    kept, spacing = _spread(points, most)
    return CloudPoints(points[kept], colours[kept], spacing)


def _without_edges(depth_m: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """Depth (H, W) with 0 where a neighbour ``step`` pixels away is much nearer or farther."""
    kept = depth_m.copy()
    for a, b in (
        ((slice(step, None), slice(None)), (slice(None, -step), slice(None))),
        ((slice(None), slice(step, None)), (slice(None), slice(None, -step))),
    ):
        jump = np.abs(depth_m[a] - depth_m[b]) > _JUMP * np.minimum(depth_m[a], depth_m[b])
        jump &= (depth_m[a] > 0) & (depth_m[b] > 0)
        kept[a][jump] = 0.0
        kept[b][jump] = 0.0
    return kept


def _spread(points: Points, most: int) -> tuple[NDArray[np.int64], float]:
    """Rows of one point per voxel, with voxels just large enough that at most ``most`` are left, and their side."""
    side = _FINEST_M
    kept = _one_per_voxel(points, side)
    while len(kept) > most:
        # Surfaces: the number of voxels falls with the square of their side.
        side *= max(1.05, (len(kept) / most) ** 0.5)
        kept = kept[_one_per_voxel(points[kept], side)]
    return kept, side


def _one_per_voxel(points: Points, side: float) -> NDArray[np.int64]:
    cells = np.floor(points / side).astype(np.int64)
    cells -= cells.min(axis=0, initial=0)
    spans = cells.max(axis=0, initial=0) + 1
    keys = (cells[:, 0] * spans[1] + cells[:, 1]) * spans[2] + cells[:, 2]
    return np.sort(np.unique(keys, return_index=True)[1])
