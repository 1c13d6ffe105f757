"""Tags and markers: axes where they are, and their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from server.scene.clouds import wxyz
from slam.geometry import Pose

if TYPE_CHECKING:
    from viser import FrameHandle, LabelHandle, SceneApi


class LandmarkLayer:
    """One frame and one label for each landmark; only poses are sent again when the map moves."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._drawn: dict[int, tuple[FrameHandle, LabelHandle]] = {}

    def draw(self, poses: Mapping[int, Pose], size: float, *, visible: bool) -> None:
        """Show landmarks, by their negative id, where ``poses`` (T_map_landmark) has them, ``size`` metres large."""
        known = {number: T for number, T in poses.items() if number < 0 and np.isfinite(T).all()}
        for number in self._drawn.keys() - known.keys():
            for handle in self._drawn.pop(number):
                handle.remove()
        for number, T_map_landmark in known.items():
            if number not in self._drawn:
                self._drawn[number] = self._add(number, size)
            frame, label = self._drawn[number]
            frame.wxyz, frame.position = wxyz(T_map_landmark), T_map_landmark[:3, 3]
            label.position = T_map_landmark[:3, 3]
            frame.visible = label.visible = visible

    def _add(self, number: int, size: float) -> tuple[FrameHandle, LabelHandle]:
        name = f"/landmark/{-number}"
        frame = self._scene.add_frame(name, axes_length=size, axes_radius=0.05 * size)
        return frame, self._scene.add_label(f"/landmark_label/{-number}", str(-number))
