"""What is selected: a node with its image, or a link with both its nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair, Snapshot
from server.scene.clouds import wxyz
from server.scene.colours import Theme
from server.scene.lines import Lines, chain, dashed
from server.scene.links import arc
from server.scene.measure import Measure
from server.scene.placed import PlacedGraph
from server.scene.tone import for_line
from slam.errors import SlamError

if TYPE_CHECKING:
    from viser import CameraFrustumHandle, LabelHandle, SceneApi

_RING_PX = 2.6
_ARC_PX = 4.5
_IMAGE_WIDTH = 360
#: Ring and frustum, by radii of a node.
_RING = 3.0
_FRUSTUM = 9.0
_TURN = np.linspace(0.0, 2.0 * np.pi, 49)


class Highlight:
    """Rings around the selected nodes with their ids, a bright arc for a link, the view of a node."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._rings = Lines(scene, "/selected/rings", _RING_PX)
        self._arc = Lines(scene, "/selected/arc", _ARC_PX)
        self._label: LabelHandle | None = None
        self._view: CameraFrustumHandle | None = None
        self._viewed: tuple[int, bool] | None = None

    def draw(
        self,
        snapshot: Snapshot,
        graph: PlacedGraph,
        node: int | None,
        link: Pair | None,
        measure: Measure,
        look: Theme,
        *,
        frustum: bool = True,
        image: bool = True,
    ) -> None:
        """Show the selection where it is now; what the map lacks is not shown.

        A single node has its ``frustum`` around it, with or without the ``image``.
        """
        pair = link if link is not None and set(link) <= graph.rows.keys() else None
        single = node if node in graph.rows else None
        ids = pair or (() if single is None else (single,))
        places = graph.positions[[graph.rows[i] for i in ids]]
        self._rings.draw(rings(places, _RING * measure.node), look.selected)
        path = arc(places[None], measure.node, 24)[0] if pair else np.zeros((0, 3))
        linked = pair is not None and (min(pair), max(pair)) in snapshot.links
        self._arc.draw(chain(path) if linked else dashed(path, measure.node), look.selected)
        top = np.concatenate([places, path])
        self._write(" → ".join(str(i) for i in ids), top.mean(axis=0) if len(top) else np.zeros(3), top, measure)
        self._show_view(snapshot, graph, None if single is None or not frustum else (single, image), measure, look)

    def _write(self, text: str, middle: NDArray[np.float64], content: NDArray[np.float64], measure: Measure) -> None:
        """Name the selection, above the middle of it."""
        if self._label is None:
            if not text:
                return
            self._label = self._scene.add_label("/selected/label", text, anchor="bottom-center")
        self._label.text = text
        self._label.visible = bool(text)
        height = float(content[:, 2].max()) + 2.0 * measure.node if len(content) else 0.0
        self._label.position = np.array([middle[0], middle[1], height])

    def _show_view(
        self, snapshot: Snapshot, graph: PlacedGraph, wanted: tuple[int, bool] | None, measure: Measure, look: Theme
    ) -> None:
        """The view of a node, with its image or without."""
        if self._view is not None and self._viewed != wanted:
            self._view.remove()
            self._view = None
        if self._view is None and wanted is not None and self._viewed != wanted:
            self._view = self._make_view(snapshot, *wanted)
        self._viewed = wanted
        if self._view is None or wanted is None:
            return
        T_map_cam = graph.T_map[graph.rows[wanted[0]]] @ self._T_base_cam
        self._view.wxyz, self._view.position = wxyz(T_map_cam), T_map_cam[:3, 3]
        self._view.scale = _FRUSTUM * measure.node
        self._view.color = for_line(look.selected)

    def _make_view(self, snapshot: Snapshot, node: int, with_image: bool) -> CameraFrustumHandle | None:
        """The frustum of a node; None for a node without a camera, or without the image that it is to have."""
        try:
            camera = snapshot.reader.camera(node)
            image = small(snapshot.reader.image_bgr(node)) if with_image else None
        except SlamError:
            # Nodes of a map that kept no images: the ring says enough.
            return None
        self._T_base_cam = camera.T_base_cam
        return self._scene.add_camera_frustum(
            "/selected/view",
            2.0 * float(np.arctan(0.5 * camera.height / camera.fy)),
            camera.width / camera.height,
            thickness=2.0,
            thickness_units="screen",
            image=image,
            format="jpeg",
            jpeg_quality=85,
            cast_shadow=False,
            receive_shadow=False,
        )


def rings(places: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Level circles (S, 2, 3) around places (N, 3)."""
    circle = radius * np.column_stack([np.cos(_TURN), np.sin(_TURN), np.zeros(len(_TURN))])
    return np.concatenate([np.zeros((0, 2, 3)), *(chain(place + circle) for place in places)])


def small(image_bgr: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The image (H, W, 3) as a thumbnail, red first."""
    height = max(1, round(image_bgr.shape[0] * _IMAGE_WIDTH / image_bgr.shape[1]))
    reduced = cv2.resize(image_bgr, (_IMAGE_WIDTH, height), interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(reduced[:, :, ::-1])
