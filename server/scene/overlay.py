"""The clouds of both nodes of a link in two colours: what the link says, and what the graph made of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from server.browse.links import measured_link
from server.browse.snapshot import Pair, Snapshot
from server.scene.clouds import wxyz
from server.scene.colours import Theme
from server.scene.node_details import word_points
from server.scene.node_points import node_points
from server.scene.placed import PlacedGraph
from server.scene.tone import Rgb
from server.schemas.scene import Overlay, OverlayPoints
from slam.errors import SlamError
from slam.geometry import Pose, inverse

if TYPE_CHECKING:
    from viser import PointCloudHandle, SceneApi

#: Points of each of the two clouds, and their size by the distance of neighbours: one must be seen through the other.
_POINTS = 40_000
_POINT_SIZE = 0.45


class OverlayLayer:
    """Two clouds, sent once for each link; going from the link's transform to the optimised poses only moves one."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._handles: dict[int, PointCloudHandle] = {}
        self._shown: tuple[Pair, Theme, OverlayPoints] | None = None

    def draw(
        self,
        snapshot: Snapshot,
        graph: PlacedGraph,
        pair: Pair | None,
        how: Overlay | None,
        look: Theme,
        *,
        of: OverlayPoints = "cloud",
    ) -> bool:
        """Show the clouds, scans or words of a link's nodes placed this way; whether there is something to show."""
        placed = _placed(snapshot, graph, pair, how)
        wanted = None if pair is None or placed is None else (pair, look, of)
        if wanted != self._shown:
            self._clear()
            self._shown = wanted
            if pair is not None and placed is not None:
                colours = (look.overlay_from, look.overlay_to)
                for node_id, T, rgb in zip(pair, placed, colours, strict=True):
                    self._send(snapshot, node_id, T, look, rgb, of)
        for node_id, T in zip(pair or (), placed or (), strict=False):
            if node_id in self._handles:
                self._handles[node_id].wxyz, self._handles[node_id].position = wxyz(T), T[:3, 3]
        return bool(self._handles)

    def _send(
        self, snapshot: Snapshot, node_id: int, T_map_base: Pose, look: Theme, rgb: Rgb, of: OverlayPoints
    ) -> None:
        try:
            if of == "words":
                words = word_points(snapshot.reader, node_id, look)
                points, size = words.points, words.size
            else:
                cloud = node_points(
                    snapshot.reader, node_id, T_map_base, _POINTS, images=_by_images(snapshot, node_id, of)
                )
                points, size = cloud.points, _POINT_SIZE * cloud.spacing
        except SlamError:
            # A node without a cloud: the other one is shown alone.
            return
        if not len(points):
            return
        self._handles[node_id] = self._scene.add_point_cloud(
            f"/overlay/{node_id}",
            points,
            np.tile(np.array(rgb, np.uint8), (len(points), 1)),
            point_size=size,
            point_shape="circle",
            point_shading="flat",
        )

    def _clear(self) -> None:
        for handle in self._handles.values():
            handle.remove()
        self._handles.clear()


def _by_images(snapshot: Snapshot, node_id: int, of: OverlayPoints) -> bool:
    """Whether its cloud is that of its depth: where there is no scan depth stands in for it, and the page says so."""
    images = {*snapshot.reader.nodes_with("image").tolist()} & {*snapshot.reader.nodes_with("depth").tolist()}
    wanted = of == "cloud" or node_id not in snapshot.scanned
    return wanted and node_id in images and node_id in snapshot.calibrated


def _placed(snapshot: Snapshot, graph: PlacedGraph, pair: Pair | None, how: Overlay | None) -> tuple[Pose, Pose] | None:
    """T_map_base of both nodes: the first where the graph has it, the other by the link or by the graph."""
    if pair is None or how is None or not set(pair) <= graph.rows.keys():
        return None
    T_from, T_to = (graph.T_map[graph.rows[node_id]] for node_id in pair)
    if how == "poses":
        return T_from, T_to
    link = measured_link(snapshot, (min(pair), max(pair)))
    if link is None or link.T_from_to is None:
        return None
    T_from_to = link.T_from_to if link.from_id == pair[0] else inverse(link.T_from_to)
    return T_from, np.asarray(T_from @ T_from_to)
