"""The points that one node adds to the view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.maps.depth_edges import without_edges
from slam.maps.point_cloud import Colors, Points, node_cloud

#: Points of all clouds of an ordinary map, and of one cloud.
_ALL = 1_000_000
_LEAST, _MOST = 4_000, 12_000
#: Depth images are read at about this many columns; at more where there is room for many points.
_COLUMNS, _FINE_COLUMNS = 160, 240
#: Beyond this a depth camera sees mostly noise.
_FAR_M = 6.0
#: Points this much higher than the camera are a ceiling to whoever looks down on the map.
_CEILING_M = 0.9
_LEAST_LEFT = 200
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
    """At most so many points of what a node saw, evenly spread; no ceiling, and nothing that hangs in the air.

    Raises:
        DatabaseError: the calibration does not say the size of its image.
    """
    if not camera.width or not camera.height:
        raise DatabaseError("the calibration does not say the size of its image: its depth has no place")
    step = max(1, round(depth_m.shape[1] / (_FINE_COLUMNS if most > 2 * _LEAST else _COLUMNS)))
    focal_px = camera.fx * depth_m.shape[1] / camera.width
    points, colours = node_cloud(image_bgr, without_edges(depth_m, step), camera, step, _FAR_M)
    if not len(points):
        return CloudPoints(points, colours, _FINEST_M)
    distance = float(np.median(np.linalg.norm(points - camera.T_base_cam[:3, 3], axis=1)))
    up_base = T_map_base[2, :3]
    above_camera = points @ up_base.astype(np.float32) - float(up_base @ camera.T_base_cam[:3, 3])
    below_ceiling = above_camera < _CEILING_M
    if below_ceiling.sum() >= _LEAST_LEFT:
        points, colours = points[below_ceiling], colours[below_ceiling]
    kept, side = spread_points(points, most)
    return CloudPoints(points[kept], colours[kept], max(side, distance * step / focal_px))


def spread_points(points: Points, most: int) -> tuple[NDArray[np.int64], float]:
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
