"""What a pixel of a node's images is: its depth as it is stored, and the point that it shows."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.errors import NotFoundError
from server.schemas import PixelDepth
from slam.camera import Camera
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import Pose, transform
from slam.maps.views import node_views

#: Images and their camera may differ by a pixel in their proportions.
_SLACK = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class _Depths:
    """Depth (h, w) in metres of all tiles of a node, 0 where unknown; its cameras, where it has any that make sense.

    ``confidence`` (h, w) is what is stored of it, 0 to 100, None where nothing of that size is.
    """

    depth_m: NDArray[np.float32]
    cameras: tuple[Camera, ...]
    stereo: bool
    confidence: NDArray[np.uint8] | None = None


class Pixels:
    """Answers for one node after the other: who moves a pointer over an image asks many times about the same."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._lock = threading.Lock()
        self._last: tuple[tuple[int, int], _Depths] | None = None

    def at(self, node_id: int, x: float, y: float, T_map_base: Pose | None, revision: int) -> PixelDepth:
        """Depth and point at a place of a node's image.

        Args:
            node_id: of the node.
            x: across the whole image, 0 at its left edge and 1 at its right.
            y: down, 0 at its top edge and 1 at its bottom.
            T_map_base: where the node is; None where that is not known.
            revision: of the map: what was read of another is read again.

        Raises:
            NotFoundError: the node has no depth.
            DatabaseError: its depth is damaged.
        """
        depths = self._depths(node_id, revision)
        height, width = depths.depth_m.shape
        column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
        depth = float(depths.depth_m[row, column])
        known = bool(np.isfinite(depth)) and depth > 0
        tile = width // max(1, len(depths.cameras))
        number = min(column // tile, max(1, len(depths.cameras)) - 1)
        camera = depths.cameras[number] if depths.cameras else None
        place = None if camera is None else _place(camera, column - number * tile, row, tile, height)
        seen = _point(camera, place, depth) if known and camera is not None and place is not None else None
        if seen is not None and not np.isfinite(seen).all():
            # A calibration with nonsense in it, which the node itself says.
            seen = None
        return PixelDepth(
            u=None if place is None or camera is None else round(place[0] + number * camera.width, 2),
            v=None if place is None else round(place[1], 2),
            depth_u=column,
            depth_v=row,
            depth_width=width,
            depth_height=height,
            depth_m=depth if known else None,
            stereo=depths.stereo,
            confidence=None if depths.confidence is None else int(depths.confidence[row, column]),
            camera=number,
            base=None if seen is None else _rounded(seen),
            map=None if seen is None or T_map_base is None else _rounded(transform(T_map_base, seen[None])[0]),
        )

    def _depths(self, node_id: int, revision: int) -> _Depths:
        with self._lock:
            if self._last is None or self._last[0] != (node_id, revision):
                self._last = (node_id, revision), self._read(node_id)
            return self._last[1]

    def _read(self, node_id: int) -> _Depths:
        node = self._reader.node(node_id)
        if not node.depth_bytes:
            raise NotFoundError(f"node {node_id} has no depth")
        cameras: tuple[Camera, ...] = ()
        if node.calibration_bytes:
            try:
                cameras = self._reader.cameras(node_id)
            except DatabaseError:
                # The node itself says so; depth is told without the point.
                return self._measured(node_id, ())
            if self._reader.baselines(node_id):
                depths = [view.depth_m for view in node_views(self._reader, node_id)]
                return _Depths(np.hstack(depths), cameras, stereo=True)
        return self._measured(node_id, cameras)

    def _measured(self, node_id: int, cameras: tuple[Camera, ...]) -> _Depths:
        depth_m = self._reader.depth_m(node_id)
        try:
            confidence = self._reader.confidence(node_id)
        except DatabaseError:
            # Its picture says so; depth is told without it.
            confidence = None
        fits = confidence is not None and confidence.shape == depth_m.shape
        return _Depths(depth_m, cameras, stereo=False, confidence=confidence if fits else None)


def _place(camera: Camera, column: int, row: int, width: int, height: int) -> tuple[float, float] | None:
    """Where a pixel of a depth image (tile) is in the camera's image, whole numbers at pixel centres.

    None where the calibration says no size, or one of other proportions.
    """
    if not camera.width or not camera.height:
        return None
    scale = camera.width / width, camera.height / height
    if abs(scale[0] - scale[1]) > _SLACK * scale[0]:
        return None
    return (column + 0.5) * scale[0] - 0.5, (row + 0.5) * scale[1] - 0.5


def _point(camera: Camera, place: tuple[float, float], depth_m: float) -> NDArray[np.float64]:
    """Point (3,) in the base frame."""
    seen = camera.unproject(np.array([place]), np.array([depth_m]))
    return np.asarray(transform(camera.T_base_cam, seen)[0])


def _rounded(point: NDArray[np.float64]) -> list[float]:
    return [round(float(value), 4) for value in point]
