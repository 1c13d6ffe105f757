"""Coloured clouds, one for each chosen node, hung on the node: a loop closure moves them and sends no point again."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from server.scene.cloud_choice import CloudChoice
from server.scene.model import SceneModel
from server.scene.placing import place
from slam.database import MapReader
from slam.errors import SlamError
from slam.maps.point_cloud import node_cloud

POINTS = 5000
_PIXEL_STEP = 4
_FAR_METRES = 4.5
_THINNING_METRES = 0.03
_POINT_SIZE = 0.016
#: Clouds made in one go; between two goes the view can show other changes.
_BATCH = 6


class CloudLayer:
    """Reads, thins and shows the clouds of the chosen nodes."""

    def __init__(self, server: viser.ViserServer, reader: MapReader) -> None:
        self._server = server
        self._reader = reader
        self._choice = CloudChoice()
        self._handles: dict[int, viser.PointCloudHandle | None] = {}
        self.floor = Floor()

    def place(self, model: SceneModel, *, visible: bool) -> None:
        """Move the clouds that are there to where their nodes are now."""
        for node_id, handle in self._handles.items():
            pose = model.pose(node_id)
            if handle is not None and pose is not None:
                place(handle, pose)
                handle.visible = visible

    def complete(self, model: SceneModel, may_go_on: Callable[[], bool]) -> bool:
        """Make some of the clouds that are missing, and take away those no longer chosen; whether more are missing."""
        chosen = self._choice.choose(model)
        for node_id in self._handles.keys() - set(chosen):
            gone = self._handles.pop(node_id)
            if gone is not None:
                gone.remove()
        missing = [node_id for node_id in chosen if node_id not in self._handles]
        for node_id in missing[:_BATCH]:
            if not may_go_on():
                return True
            self._handles[node_id] = self._add(node_id, model)
        return len(missing) > _BATCH

    def _add(self, node_id: int, model: SceneModel) -> viser.PointCloudHandle | None:
        """The cloud of a node; None when the file has no image, depth or camera for it."""
        try:
            points, colors = self._cloud(node_id)
        except SlamError:
            # Not every node of every file has all three; such a node simply has no cloud.
            return None
        if not len(points):
            return None
        pose = model.T_map_base[model.rows[node_id]]
        self.floor.take_in((points @ pose[:3, :3].T + pose[:3, 3])[:, 2])
        handle = self._server.scene.add_point_cloud(
            f"/clouds/{node_id}", points, colors, point_size=_POINT_SIZE, point_shape="square", point_shading="flat"
        )
        place(handle, pose)
        return handle

    def _cloud(self, node_id: int) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        image, depth = self._reader.image_bgr(node_id), self._reader.depth_m(node_id)
        points, colors = node_cloud(image, depth, self._reader.camera(node_id), _PIXEL_STEP, _FAR_METRES)
        return thinned(points, colors, np.random.default_rng(node_id))


class Floor:
    """Guesses the height of the floor: what nearly all points are above."""

    def __init__(self) -> None:
        self._lows: list[float] = []

    def take_in(self, heights: NDArray[np.floating]) -> None:
        """Heights of the points of one cloud."""
        self._lows.append(float(np.percentile(heights, 1)))

    @property
    def height(self) -> float | None:
        """Metres in the map; None before the first cloud."""
        return float(np.percentile(self._lows, 15)) if self._lows else None


def thinned(
    points: NDArray[np.float32], colors: NDArray[np.uint8], rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """One point for each small cube, at most ``POINTS`` of them, any of them as likely as any other."""
    cubes = np.floor(points / _THINNING_METRES).astype(np.int64)
    _, first = np.unique(cubes, axis=0, return_index=True)
    if len(first) > POINTS:
        first = rng.choice(first, POINTS, replace=False)
    return points[first], colors[first]
