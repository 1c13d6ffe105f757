"""Surfaces of one node: the mesh of its depth images, and the heights of what stands in each cell around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from server.schemas.scene import DepthUse
from slam.camera import Camera
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.maps.depth_edges import without_edges
from slam.maps.local_grid import level
from slam.maps.point_cloud import Colors, Points, node_cloud
from slam.maps.views import View, node_views

if TYPE_CHECKING:
    import trimesh

Triangles = NDArray[np.int64]

#: Corners of a mesh that are sent at most, and how far away they may be.
_MOST, _FAR_M = 80_000, 30.0
#: A triangle with an edge nearer to the line of sight than this spans a gap between two surfaces.
_SHADOW = np.cos(np.radians(12.0))
#: Cells of a node without a local grid, metres; heights reach so far, and no ceiling is shown.
_CELL_M, _REACH_M, _CEILING_M = 0.05, 8.0, 0.9
_STEP = 2
#: Colours of heights, blue to red.
_RAINBOW = np.asarray(cv2.applyColorMap(np.arange(256, dtype=np.uint8)[None], cv2.COLORMAP_TURBO), np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Corners (N, 3) in metres, triangles (M, 3) of rows of them, and where each corner is in a picture of its colours.

    ``places`` (N, 2) go from 0 to 1, rightwards and upwards, over the picture (H, W, 3), blue first.
    """

    corners: Points
    triangles: Triangles
    places: NDArray[np.float64]
    picture: Colors


def node_mesh(reader: MapReader, node_id: int, use: DepthUse) -> Surface:
    """Neighbouring pixels with depth joined by triangles, in the base frame, in the colours of the image.

    Two triangles for each square of pixels, as in PCL's OrganizedFastMesh; those that are seen edge-on are left out.

    Raises:
        SlamError: images can't be read, or there is no depth.
    """
    views = node_views(reader, node_id)
    parts = [_view_mesh(view, _MOST // len(views), use) for view in views]
    starts = np.cumsum([0, *(len(part.corners) for part in parts[:-1])])
    # The pictures of several cameras lie side by side again.
    sides = [(part.places + np.array([at, 0.0])) / np.array([len(parts), 1.0]) for at, part in enumerate(parts)]
    return Surface(
        np.concatenate([part.corners for part in parts]),
        np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=True)]),
        np.concatenate(sides),
        np.hstack([part.picture for part in parts]),
    )


def node_elevation(reader: MapReader, node_id: int, T_map_base: Pose) -> Surface:
    """The highest point in each cell around a node, as tiles with walls between them, coloured by height.

    Cells are those of its local grid; points come of its depth, else of its scan. What is above ``_CEILING_M`` over
    the base's origin hides what is below and is left out. Corners are in the base frame, levelled: turn them by the
    yaw of the base alone.

    Raises:
        SlamError: what it saw can't be read, or it saw nothing.
    """
    grid = reader.local_grid(node_id)
    points = _points(reader, node_id) @ level(T_map_base)[:3, :3].T
    near = (np.abs(points[:, :2]).max(axis=1, initial=0.0) < _REACH_M) & (points[:, 2] < _CEILING_M)
    if not near.any():
        raise DatabaseError(f"node {node_id} saw nothing within {_REACH_M:g} m")
    return elevation(points[near], grid.cell_size if grid is not None else _CELL_M)


def elevation(points: NDArray[np.floating], cell_m: float) -> Surface:
    """Tiles at the height of the highest of the points (N, 3) in each cell of this size, z up."""
    columns = np.floor(points[:, :2] / cell_m).astype(np.int64)
    low = columns.min(axis=0)
    rows, cols = columns.max(axis=0) - low + 1
    heights = np.full((rows, cols), -np.inf)
    np.maximum.at(heights, tuple((columns - low).T), points[:, 2])
    x, y = np.nonzero(np.isfinite(heights))
    z = heights[x, y]
    tiles = _squares((x, y, z), (x + 1, y, z), (x + 1, y + 1, z), (x, y + 1, z))
    walls = []
    for axis, (dx, dy) in enumerate(((0, 1), (1, 0))):
        # Between a cell and the next one along the other axis.
        a, b = (heights[:-1], heights[1:]) if axis == 0 else (heights[:, :-1], heights[:, 1:])
        u, v = np.nonzero(np.isfinite(a) & np.isfinite(b) & (a != b))
        over, under = a[u, v], b[u, v]
        u0, v0 = (u + 1, v) if axis == 0 else (u, v + 1)
        walls.append(_squares((u0, v0, over), (u0 + dx, v0 + dy, over), (u0 + dx, v0 + dy, under), (u0, v0, under)))
    corners = np.concatenate([tiles, *walls])
    corners[:, :2] = (corners[:, :2] + low) * cell_m
    first = 4 * np.arange(len(corners) // 4)[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    least, most = np.percentile(z, [2.0, 98.0])
    share = np.clip((corners[:, 2] - least) / max(float(most - least), 1e-6), 0.0, 1.0)
    # The middle of the first and of the last colour are half a pixel from the picture's edges.
    places = np.column_stack([(share * 255.0 + 0.5) / 256.0, np.full(len(share), 0.5)])
    return Surface(corners.astype(np.float32), triangles, places, _RAINBOW)


def _squares(*corners: tuple[NDArray[np.generic], ...]) -> NDArray[np.float64]:
    """Corners (4 N, 3), four of each square one after the other."""
    each = np.stack([np.column_stack(corner).astype(np.float64) for corner in corners], axis=1)
    return each.reshape(-1, 3)


def _points(reader: MapReader, node_id: int) -> NDArray[np.float64]:
    """Points (N, 3) in the base frame: of depth images, else of the scan."""
    node = reader.node(node_id)
    if node.image_bytes and node.depth_bytes and node.calibration_bytes:
        views = node_views(reader, node_id)
        clouds = [node_cloud(v.image_bgr, v.depth_m, _sized(v.camera), _STEP, 2.0 * _REACH_M)[0] for v in views]
        return np.concatenate(clouds).astype(np.float64)
    scan = reader.scan(node_id)
    if scan is None:
        raise DatabaseError(f"node {node_id} has neither depth nor a scan")
    return scan.points_base.astype(np.float64)


def _view_mesh(view: View, most: int, use: DepthUse) -> Surface:
    step, far_m = max(use.every, int(np.ceil((view.depth_m.size / most) ** 0.5))), use.far_m or _FAR_M
    depth_m = view.depth_m if use.edges else without_edges(view.depth_m)
    seen = depth_m[::step, ::step]
    known = np.isfinite(seen) & (seen > 0) & (seen <= far_m)
    if not known.any():
        raise DatabaseError(f"the depth image has no such pixel with depth up to {far_m:g} m")
    points, _ = node_cloud(view.image_bgr, depth_m, _sized(view.camera), step, far_m)
    index = np.full(seen.shape, -1)
    index[known] = np.arange(len(points))
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    both = np.concatenate([np.stack([a, d, b], -1).reshape(-1, 3), np.stack([b, d, c], -1).reshape(-1, 3)])
    both = both[(both >= 0).all(axis=1)]
    v, u = np.nonzero(known)
    height, width = view.depth_m.shape
    places = np.column_stack([(u * step + 0.5) / width, 1.0 - (v * step + 0.5) / height])
    kept = both[~_edge_on(points - view.camera.T_base_cam[:3, 3], both)]
    return Surface(points, kept, places, view.image_bgr)


def _edge_on(rays: NDArray[np.floating], triangles: Triangles) -> NDArray[np.bool_]:
    """Which triangles (M, 3) have an edge along the line of sight; rays (N, 3) go from the camera to the corners."""
    found = np.zeros(len(triangles), bool)
    for one, other in ((0, 1), (1, 2), (2, 0)):
        start, end = rays[triangles[:, one]], rays[triangles[:, other]]
        edge, sight = end - start, end + start
        along = np.abs((edge * sight).sum(axis=1))
        found |= along > _SHADOW * np.linalg.norm(edge, axis=1) * np.linalg.norm(sight, axis=1)
    return found


def _sized(camera: Camera) -> Camera:
    if not camera.width or not camera.height:
        raise DatabaseError("the calibration does not say the size of its image: its depth has no place")
    return camera


def as_trimesh(surface: Surface) -> trimesh.Trimesh:
    """The surface with its picture as the texture."""
    import trimesh
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(surface.picture[..., ::-1]))
    visual = cast("Any", trimesh.visual.TextureVisuals)(uv=surface.places, image=image)
    return trimesh.Trimesh(surface.corners, surface.triangles, visual=visual, process=False)
