"""Landmarks are drawn once, moved with the map, and go when they are gone."""

from __future__ import annotations

from typing import Any

import numpy as np

from server.scene.landmarks import LandmarkLayer
from slam.geometry import make


def test_landmarks_are_drawn_moved_and_removed(viewer: Any) -> None:
    layer = LandmarkLayer(viewer.scene)
    T = make(np.eye(3), np.array([1.0, 2.0, 3.0]))
    layer.draw({-7: T, 3: np.eye(4), -8: np.full((4, 4), np.nan)}, 0.2, visible=True)
    assert layer._drawn.keys() == {-7}
    frame, label = layer._drawn[-7]
    assert frame.position.tolist() == label.position.tolist() == [1.0, 2.0, 3.0]
    assert label.text == "7"
    layer.draw({-7: make(np.eye(3), np.array([4.0, 2.0, 3.0]))}, 0.2, visible=False)
    assert layer._drawn[-7] == (frame, label)
    assert frame.position.tolist() == [4.0, 2.0, 3.0]
    assert not frame.visible
    layer.draw({}, 0.2, visible=True)
    assert layer._drawn == {}
