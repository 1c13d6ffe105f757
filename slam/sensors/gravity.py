"""Attitude from an accelerometer: which way is up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, make
from slam.sensors.lists import read_table

WINDOW_S = 0.5
#: The mean may be this far from one g; beyond it the camera's own motion decides the direction.
TOLERANCE = 0.15
GRAVITY = 9.80665
_COLUMNS = "stamp ax ay az"

#: The Kinect's accelerometer has x left, y up, z forward, and at rest it reads +g upwards (specific force): the
#: optical frame turned half round its z axis. Found by comparing accelerometer.txt with the truth of freiburg1_xyz:
#: their directions agree to 4 degrees, most of it the sensor's constant offset.
R_CAM_ACCELEROMETER: NDArray[np.float64] = np.diag([-1.0, -1.0, 1.0])


class Gravity:
    """Specific force at ascending stamps, in the accelerometer's axes, m/s^2."""

    def __init__(self, stamps: NDArray[np.float64], forces: NDArray[np.float64]):
        self._stamps = stamps
        self._sums = np.vstack([np.zeros(3), np.cumsum(forces, axis=0)])

    @classmethod
    def read(cls, path: Path) -> Gravity:
        """Record of an accelerometer.txt; empty when there is no such file. Raises SourceError for a bad line."""
        table = read_table(path, _COLUMNS) if path.exists() else np.empty((0, 4))
        return cls(table[:, 0], table[:, 1:])

    def at(self, stamp: float, camera: Camera) -> Pose | None:
        """T_gravity_base, rotation only, from the mean over half a second around a stamp; None where it can't tell."""
        low = int(np.searchsorted(self._stamps, stamp - WINDOW_S / 2, side="left"))
        high = int(np.searchsorted(self._stamps, stamp + WINDOW_S / 2, side="right"))
        if high == low:
            return None
        force = (self._sums[high] - self._sums[low]) / (high - low)
        if abs(np.linalg.norm(force) - GRAVITY) > TOLERANCE * GRAVITY:
            return None
        return level(camera.T_base_cam[:3, :3] @ R_CAM_ACCELEROMETER @ force)


def level(up_base: NDArray[np.float64]) -> Pose:
    """T_gravity_base with yaw 0 (no translation) from the upward direction in the base frame, (3,) of any length."""
    z = up_base / np.linalg.norm(up_base)
    forward = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.99 else np.array([0.0, 0.0, -np.sign(z[0])])
    x = forward - z * (z @ forward)
    x /= np.linalg.norm(x)
    return make(np.vstack([x, np.cross(z, x), z]), np.zeros(3))
