"""The points of one node in full, each kind in its own colours, in the base frame."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from server.scene.cloud_points import spread_points
from server.scene.colours import Theme
from server.schemas.scene import DepthUse
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.maps.depth_edges import without_edges
from slam.maps.point_cloud import Colors, Points, node_cloud
from slam.maps.views import View, node_views

#: Points of a node's cloud and of its scan that are sent at most.
_MOST_CLOUD, _MOST_SCAN = 320_000, 200_000
#: Beyond this a depth camera has said nothing for a long time.
_FAR_M = 30.0
#: Words, by how far away they are, and the least size of a point, metres.
_WORD_SIZE, _LEAST_M = 0.008, 0.004


@dataclass(frozen=True, slots=True, eq=False)
class DetailPoints:
    """Points (N, 3) float32, their colours (N, 3) red first, and the size of a point in metres."""

    points: Points
    colours: Colors
    size: float


def dense_points(reader: MapReader, node_id: int, use: DepthUse) -> DetailPoints:
    """The pixels with depth of all cameras of a node; every so manieth where it has more than can be shown.

    Raises:
        SlamError: images can't be read.
    """
    views = node_views(reader, node_id)
    each = [_view_points(view, _MOST_CLOUD // len(views), use) for view in views]
    return DetailPoints(
        np.concatenate([part.points for part in each]),
        np.concatenate([part.colours for part in each]),
        max(part.size for part in each),
    )


def _view_points(view: View, most: int, use: DepthUse) -> DetailPoints:
    if not view.camera.width or not view.camera.height:
        raise DatabaseError("the calibration does not say the size of its image: its depth has no place")
    step = max(use.every, int(np.ceil((view.depth_m.size / most) ** 0.5)))
    depth_m = view.depth_m if use.edges else without_edges(view.depth_m)
    points, colours = node_cloud(view.image_bgr, depth_m, view.camera, step, use.far_m or _FAR_M)
    distance = float(np.median(np.linalg.norm(points, axis=1))) if len(points) else 1.0
    focal_px = view.camera.fx * view.depth_m.shape[1] / view.camera.width
    return DetailPoints(points, colours, max(_LEAST_M, 0.9 * distance * step / focal_px))


def word_points(reader: MapReader, node_id: int, look: Theme) -> DetailPoints:
    """Key points that have a place: words of the dictionary, and others.

    Raises:
        SlamError: they can't be read.
    """
    features, words = reader.features(node_id)
    placed = np.isfinite(features.points_base).all(axis=1)
    points = features.points_base[placed].astype(np.float32)
    colours = np.where(words[placed, None] > 0, np.array(look.wm), np.array(look.stm)).astype(np.uint8)
    distance = float(np.median(np.linalg.norm(points, axis=1))) if len(points) else 1.0
    return DetailPoints(points, colours, max(2.0 * _LEAST_M, _WORD_SIZE * distance))


def scan_points(reader: MapReader, node_id: int, look: Theme) -> DetailPoints:
    """The scan by its colours or intensities; where neither tells points apart, by the directions of its normals.

    Raises:
        SlamError: it can't be read, or there is none.
    """
    stored = reader.stored_scan(node_id)
    if stored is None or not len(stored.scan):
        raise DatabaseError(f"node {node_id} has no points of a scanner")
    points = stored.scan.points_base
    kept, side = spread_points(points, _MOST_SCAN)
    if stored.colours is not None:
        colours = stored.colours[kept]
    elif stored.intensities is not None and np.ptp(stored.intensities[kept]) > 0:
        colours = _by_value(stored.intensities[kept])
    elif stored.scan.normals_base is not None:
        colours = np.rint((stored.scan.normals_base[kept] + 1.0) * 127.5).astype(np.uint8)
    else:
        colours = np.tile(np.array(look.overlay_from, np.uint8), (len(kept), 1))
    distance = float(np.median(np.linalg.norm(points[kept], axis=1))) if len(kept) else 1.0
    return DetailPoints(points[kept], colours, max(side, _WORD_SIZE * distance))


def _by_value(values: NDArray[np.float32]) -> Colors:
    """Colours (N, 3), red first, of values (N,), from blue to red."""
    finite = np.nan_to_num(values.astype(np.float64), posinf=0.0, neginf=0.0)
    low, high = np.percentile(finite, [2.0, 98.0]) if len(finite) else (0.0, 1.0)
    level = np.rint(np.clip((finite - low) / max(high - low, 1e-9), 0.0, 1.0) * 255.0).astype(np.uint8)
    return np.ascontiguousarray(cv2.applyColorMap(level[:, None], cv2.COLORMAP_TURBO)[:, 0, ::-1])
