"""Where the robot is: the newest pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from server.scene.clouds import wxyz
from server.scene.colours import Theme
from server.scene.frusta import OPENING
from server.scene.placed import PlacedGraph
from server.scene.tone import for_line
from slam.camera import T_BASE_OPTICAL
from slam.geometry import Pose

if TYPE_CHECKING:
    from viser import CameraFrustumHandle, SceneApi


class NewestLayer:
    """A filled frustum at the newest node."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._frustum: CameraFrustumHandle | None = None

    def draw(
        self, graph: PlacedGraph, size: float, look: Theme, *, visible: bool, T_map_base: Pose | None = None
    ) -> None:
        """Show it at a pose, or where the newest node is now, ``size`` metres large."""
        if self._frustum is None:
            fov, aspect = OPENING
            self._frustum = self._scene.add_camera_frustum(
                "/newest",
                fov,
                aspect,
                thickness=2.0,
                thickness_units="screen",
                variant="filled",
                cast_shadow=False,
                receive_shadow=False,
            )
        frustum = self._frustum
        frustum.visible = visible and len(graph) > 0
        frustum.color = for_line(look.newest)
        frustum.scale = size
        if len(graph):
            self.move(graph.T_map[-1] if T_map_base is None else T_map_base)

    def move(self, T_map_base: Pose) -> None:
        """Put it there; nothing happens before it was drawn."""
        if self._frustum is not None:
            T_map_cam = np.asarray(T_map_base @ T_BASE_OPTICAL)
            self._frustum.wxyz, self._frustum.position = wxyz(T_map_cam), T_map_cam[:3, 3]
