"""Poses as viser wants them."""

from __future__ import annotations

import numpy as np
import viser

from slam.geometry import Pose, to_quat_xyzw


def wxyz(T_a_b: Pose) -> np.ndarray:
    """Quaternion w x y z of a pose."""
    x, y, z, w = to_quat_xyzw(T_a_b)
    return np.array([w, x, y, z])


def place(handle: viser.SceneNodeHandle, T_a_b: Pose) -> None:
    """Put something where a pose says; nothing is sent when it is there already."""
    position, quat = T_a_b[:3, 3], wxyz(T_a_b)
    if not np.allclose(handle.position, position, atol=1e-5):
        handle.position = position
    if not np.allclose(handle.wxyz, quat, atol=1e-6):
        handle.wxyz = quat
