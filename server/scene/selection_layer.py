"""What is selected, lit up."""

from __future__ import annotations

import numpy as np
import viser

from server.browse.snapshot import Pair
from server.scene import palette
from server.scene.camera_layer import opening
from server.scene.link_layer import loop_cylinders
from server.scene.model import SceneModel
from server.scene.placing import place
from server.scene.shapes import cylinder, sphere
from slam.camera import Camera
from slam.database import MapReader
from slam.errors import SlamError

_HALO_RADIUS = 0.42
_LINK_RADIUS = 0.12
_VIEW_SIZE = 2.5
_VIEW_PIXELS = 240


class SelectionLayer:
    """Draws a halo around the selected nodes, the selected link, and the view of a selected node."""

    def __init__(self, server: viser.ViserServer, reader: MapReader) -> None:
        self._server = server
        self._reader = reader
        self._shown: int | None = None
        self._view: viser.CameraFrustumHandle | None = None

    def draw(self, model: SceneModel, node_id: int | None, pair: Pair | None) -> None:
        """Show what is selected; what is not there (any more) is left out."""
        ids = [i for i in (node_id, *(pair or ())) if i is not None and i in model.rows]
        self._draw_halos(model, ids)
        self._draw_link(model, pair if pair is not None and set(pair) <= model.rows.keys() else None)
        self._draw_view(model, node_id if node_id in model.rows else None)

    def _draw_halos(self, model: SceneModel, ids: list[int]) -> None:
        if not ids:
            self._server.scene.remove_by_name("/selection/halos")
            return
        self._server.scene.add_batched_meshes_simple(
            "/selection/halos",
            *sphere(),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(ids), 1)),
            batched_positions=model.positions[[model.rows[i] for i in ids]],
            batched_scales=np.full(len(ids), _HALO_RADIUS * model.step),
            batched_colors=palette.SELECTED,
            opacity=0.55,
            cast_shadow=False,
            receive_shadow=False,
            lod="off",
        )

    def _draw_link(self, model: SceneModel, pair: Pair | None) -> None:
        if pair is None:
            self._server.scene.remove_by_name("/selection/link")
            return
        quats, positions, scales = loop_cylinders(model, [pair], _LINK_RADIUS * model.step)
        self._server.scene.add_batched_meshes_simple(
            "/selection/link",
            *cylinder(),
            batched_wxyzs=quats,
            batched_positions=positions,
            batched_scales=scales,
            batched_colors=palette.SELECTED,
            cast_shadow=False,
            receive_shadow=False,
            lod="off",
        )

    def _draw_view(self, model: SceneModel, node_id: int | None) -> None:
        if node_id != self._shown and self._view is not None:
            self._view.remove()
            self._view = None
        if node_id is not None and self._view is None:
            self._view = self._add_view(model, node_id)
        self._shown = node_id
        pose = None if node_id is None else model.pose(node_id)
        if self._view is not None and pose is not None:
            place(self._view, pose @ self._camera(node_id).T_base_cam)

    def _add_view(self, model: SceneModel, node_id: int) -> viser.CameraFrustumHandle | None:
        """The node's camera with what it saw; None when the file has no camera or image for it."""
        try:
            camera, image = self._camera(node_id), self._reader.image_bgr(node_id)
        except SlamError:
            return None
        fov, aspect = opening(camera)
        stride = max(1, image.shape[1] // _VIEW_PIXELS)
        return self._server.scene.add_camera_frustum(
            "/selection/view",
            fov=fov,
            aspect=aspect,
            scale=_VIEW_SIZE * model.step,
            thickness=2.0,
            thickness_units="screen",
            color=palette.SELECTED,
            image=np.ascontiguousarray(image[::stride, ::stride, ::-1]),
            cast_shadow=False,
            receive_shadow=False,
        )

    def _camera(self, node_id: int | None) -> Camera:
        return self._reader.camera(node_id or 0)
