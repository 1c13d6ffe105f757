"""What one depth image says about the floor plan: ground, obstacles, and free cells between."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Array, Pose, make
from slam.maps.kernels import grow_ground, normals, trace_rays
from slam.params import Params
from slam.types import LocalGrid

#: A patch of obstacle or floor of fewer samples is noise (RTAB-Map's Grid/MinClusterSize).
MIN_SAMPLES = 10
#: Neighbouring ground cells differ by less than this in height, metres (RTAB-Map's Grid/ClusterRadius).
MAX_STEP = 0.1
#: A level is the floor when it has at least this share of the cells of the largest level and lies below it.
_FLOOR_SHARE = 0.3

Cells = NDArray[np.int64]
Mask = NDArray[np.bool_]


def level(T_map_base: Pose) -> Pose:
    """``T_level_base``: the roll and pitch of a pose, without its yaw and translation.

    ``T_map_base`` is then a turn by ``yaw(T_map_base)``, a shift, and this. It is the smallest turn that makes the z
    axis vertical after which base's x axis keeps its heading, and thus defined for a camera that looks straight down.
    """
    c, s = np.cos(yaw(T_map_base)), np.sin(yaw(T_map_base))
    R_level_map = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return make(R_level_map @ T_map_base[:3, :3], np.zeros(3))


def yaw(T_map_base: Pose) -> float:
    """Heading in radians of a pose's x axis, or of its z axis where x is vertical."""
    x, z = T_map_base[:3, 0], T_map_base[:3, 2]
    heading = x if abs(x[2]) < 0.99 else -np.sign(x[2]) * z
    return float(np.arctan2(heading[1], heading[0]))


def make_local_grid(depth_m: NDArray[np.float32], camera: Camera, T_level_base: Pose, params: Params) -> LocalGrid:
    """Segment a depth image into cells of ground and obstacle, and trace the free cells between.

    After RTAB-Map's ``LocalGridMaker`` with normals: a surface less than ``Grid/MaxGroundAngle`` from level is flat;
    flat cells that join the floor in small steps are ground, flat cells elsewhere (a table) and all else are
    obstacles. The floor is the lowest well-populated level. Unlike there, flat surfaces seen from below (ceilings)
    are no obstacles.

    Args:
        depth_m: (H, W) metres along the optical axis, 0 where unknown.
        camera: camera of this depth image.
        T_level_base: (4, 4) rotation that makes the base level, see ``level``.
        params: the ``Grid/`` group.

    Returns:
        Cell centres in the levelled base frame; a cell is in at most one of the three arrays.
    """
    grid, size = params.Grid, params.Grid.CellSize
    step = grid.DepthDecimation
    T_level_cam = T_level_base @ camera.T_base_cam
    view_point = T_level_cam[:3, 3]
    z = np.ascontiguousarray(depth_m[::step, ::step], dtype=np.float32)
    far = grid.RangeMax if grid.RangeMax > 0 else np.inf
    z = np.where((z > grid.RangeMin) & (z <= far), z, np.float32(0))
    rays = _rays(camera, z.shape, step)
    normal_cam, found = normals(z, rays[0], rays[1])
    points = _levelled(z, rays, T_level_cam)
    up = normal_cam @ T_level_cam[2, :3]
    keep = found > 0
    if grid.MaxObstacleHeight != 0:
        keep &= points[..., 2] <= grid.MaxObstacleHeight
    flat = keep & (np.abs(up) >= np.cos(np.radians(grid.MaxGroundAngle))) & (found > 1)
    # Normals look at the camera: one that points down belongs to something seen from below.
    keep &= ~(flat & (up < 0))
    flat &= up > 0
    points, flat = points[keep], flat[keep]
    return _cells(points, flat, view_point, params) if len(points) else _nothing(size, view_point)


def _cells(points: Array, flat: Mask, view_point: Array, params: Params) -> LocalGrid:
    """Sort points (N, 3) of the levelled frame into cells."""
    size = params.Grid.CellSize
    column, start = np.floor(points[:, :2] / size).astype(np.int64), view_point[:2] / size
    low = np.minimum(column.min(axis=0), np.floor(start).astype(np.int64))
    shape = np.maximum(column.max(axis=0), np.floor(start).astype(np.int64)) - low + 1
    index = (column[:, 0] - low[0]) * shape[1] + column[:, 1] - low[1]
    ground, height = _ground(index[flat], points[flat, 2], tuple(shape), params)
    # A flat sample may share its cell with ground and yet lie far above it: the edge of a table over the floor.
    raised = ~flat | ~ground.reshape(-1)[index] | (points[:, 2] > height.reshape(-1)[index] + MAX_STEP)
    obstacle = _without_specks(np.bincount(index[raised], minlength=ground.size).reshape(shape))
    ground &= ~obstacle
    empty = np.zeros_like(ground)
    if params.Grid.RayTracing:
        row, col = start - low
        empty = trace_rays(obstacle, row, col) & ~ground
    ground_cells, obstacle_cells, empty_cells = (_centres(mask, low, size) for mask in (ground, obstacle, empty))
    return LocalGrid(ground_cells, obstacle_cells, empty_cells, size, _triple(view_point))


def _ground(index: Cells, z: Array, shape: tuple[int, ...], params: Params) -> tuple[Mask, Array]:
    """Cells of ground and the mean height of the flat samples in each, both of ``shape``; ``index`` is flattened."""
    size, limit, cells = params.Grid.CellSize, params.Grid.MaxGroundHeight, int(np.prod(shape))
    count = np.bincount(index, minlength=cells)
    height = (np.bincount(index, weights=z, minlength=cells) / np.maximum(count, 1)).reshape(shape)
    may_be = (count > 0).reshape(shape) & (height <= (limit if limit != 0 else np.inf))
    return grow_ground(may_be, height, _floor(height[may_be], size), size, MAX_STEP), height


def _floor(heights: Array, size: float) -> float:
    """Height of the lowest level that has many flat cells; NaN when there is none."""
    if len(heights) < MIN_SAMPLES:
        return np.nan
    bins = np.floor(heights / size).astype(np.int64)
    count = np.bincount(bins - bins.min())
    # Two bins together, so that a floor on the border of bins counts whole.
    pairs = count + np.append(count[1:], 0)
    enough = pairs >= max(_FLOOR_SHARE * pairs.max(), MIN_SAMPLES)
    lowest = bins.min() + int(np.argmax(enough))
    on_it = heights[(bins == lowest) | (bins == lowest + 1)]
    return float(np.median(on_it)) if enough.any() else np.nan


def _without_specks(count: NDArray[np.int64]) -> Mask:
    """Cells of 8-connected patches that hold at least ``MIN_SAMPLES`` samples."""
    patches, labels = cv2.connectedComponents((count > 0).astype(np.uint8), connectivity=8)
    samples = np.bincount(labels.reshape(-1), weights=count.reshape(-1), minlength=patches)
    samples[0] = 0
    return np.asarray((samples >= MIN_SAMPLES)[labels])


def _rays(camera: Camera, shape: tuple[int, ...], step: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """x / z of each column and y / z of each row of the decimated image."""
    x = (np.arange(shape[1]) * step - camera.cx) / camera.fx
    y = (np.arange(shape[0]) * step - camera.cy) / camera.fy
    return x.astype(np.float32), y.astype(np.float32)


def _levelled(z: NDArray[np.float32], rays: tuple[NDArray[np.float32], NDArray[np.float32]], T: Pose) -> Array:
    """Points (h, w, 3) of a depth image in the frame that T (4, 4) takes optical points to."""
    points = np.empty((*z.shape, 3))
    points[..., 0] = z * rays[0]
    points[..., 1] = z * rays[1][:, None]
    points[..., 2] = z
    return np.asarray(points @ T[:3, :3].T + T[:3, 3])


def _centres(mask: Mask, low: Cells, size: float) -> NDArray[np.float32]:
    return np.asarray(((np.argwhere(mask) + low + 0.5) * size).astype(np.float32).reshape(-1, 2))


def _nothing(size: float, view_point: Array) -> LocalGrid:
    none = np.zeros((0, 2), dtype=np.float32)
    return LocalGrid(none, none, none, size, _triple(view_point))


def _triple(v: Array) -> tuple[float, float, float]:
    return float(v[0]), float(v[1]), float(v[2])
