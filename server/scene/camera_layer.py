"""Cameras: where the run is now, and the view of each node."""

from __future__ import annotations

import numpy as np
import viser

from server.scene import palette
from server.scene.model import Array, SceneModel
from server.scene.placing import place
from slam.camera import T_BASE_OPTICAL, Camera
from slam.geometry import Pose

_NOW_SIZE = 1.4
_NODE_SIZE = 0.7


class CameraLayer:
    """Draws the camera of the run as a filled frustum, those of the nodes as one batch of lines."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._now: viser.CameraFrustumHandle | None = None
        self._frusta: viser.LineSegmentsHandle | None = None
        self._camera: Camera | None = None

    def use(self, camera: Camera | None) -> None:
        """The camera whose proportions are drawn."""
        self._camera = camera

    def move(self, T_map_base: Pose | None, step: float) -> None:
        """Where the run is now; None while it is lost: then the last place is shown in red."""
        if T_map_base is None:
            if self._now is not None:
                self._now.color = palette.LOST
            return
        if self._now is None:
            self._now = self._add_now(step)
        self._now.color = palette.CAMERA
        self._now.visible = True
        place(self._now, T_map_base @ self._T_base_cam)

    def draw_frusta(self, model: SceneModel, *, visible: bool) -> None:
        """Show the view of every node."""
        if not visible or not len(model.ids):
            if self._frusta is not None:
                self._frusta.visible = False
            return
        lines = self._lines(model).astype(np.float32)
        if self._frusta is None:
            self._frusta = self._server.scene.add_line_segments(
                "/frusta", lines, palette.FRUSTA, thickness=1.0, thickness_units="screen"
            )
        else:
            self._frusta.points = lines
        self._frusta.visible = True

    @property
    def _T_base_cam(self) -> Pose:
        return T_BASE_OPTICAL if self._camera is None else self._camera.T_base_cam

    def _add_now(self, step: float) -> viser.CameraFrustumHandle:
        fov, aspect = opening(self._camera)
        return self._server.scene.add_camera_frustum(
            "/camera",
            fov=fov,
            aspect=aspect,
            scale=_NOW_SIZE * step,
            thickness=2.0,
            thickness_units="screen",
            color=palette.CAMERA,
            variant="filled",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _lines(self, model: SceneModel) -> Array:
        fov, aspect = opening(self._camera)
        half = np.tan(fov / 2)
        corners = np.array([(sx * half * aspect, sy * half, 1.0) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        points_cam = np.vstack([np.zeros(3), corners * _NODE_SIZE * model.step])
        T = model.T_map_base @ self._T_base_cam
        points = np.einsum("nij,pj->npi", T[:, :3, :3], points_cam) + T[:, None, :3, 3]
        edges = [(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)]
        return np.asarray(points[:, edges].reshape(-1, 2, 3))


def opening(camera: Camera | None) -> tuple[float, float]:
    """Vertical field of view in radians and width over height; those of a Kinect where no camera is known."""
    if camera is None:
        return float(np.radians(45.0)), 4 / 3
    return float(2 * np.arctan(0.5 * camera.height / camera.fy)), camera.width / camera.height
