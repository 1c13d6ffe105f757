"""Odometry from outside, of wheels for example, beside the images of a recorded sequence."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.geometry import from_quat_xyzw, interpolate, inverse, make, so3_exp, translation_norm
from slam.sensors.lists import read_table
from slam.types import ExternalOdometry

_POSES = "stamp tx ty tz qx qy qz qw"
_INCREMENTS = "stamp dx dy dyaw sigma_m sigma_rad"
#: Where poses come without their errors: standard deviation after a metre, that grows with the root of the way.
_SIGMA_M, _SIGMA_RAD = 0.02, 0.01

Array = NDArray[np.float64]


class Wheels:
    """Poses (N, 4, 4) of the base in a frame of their own at ascending stamps, and variances (N, 2) since the start."""

    def __init__(self, stamps: Array, poses: Array, variances: Array):
        self._stamps = stamps
        self._poses = poses
        self._variances = variances

    @classmethod
    def read(cls, folder: Path) -> Wheels:
        """From ``odometry.txt`` (poses) or ``wheels.txt`` (planar increments with their sigmas); empty without both.

        Raises:
            SourceError: a line does not have the columns above, or stamps go back.
        """
        if (folder / "odometry.txt").exists():
            return cls._of_poses(read_table(folder / "odometry.txt", _POSES))
        if (folder / "wheels.txt").exists():
            return cls._of_increments(read_table(folder / "wheels.txt", _INCREMENTS))
        return cls(np.zeros(0), np.zeros((0, 4, 4)), np.zeros((0, 2)))

    @classmethod
    def _of_poses(cls, table: Array) -> Wheels:
        poses = np.array([from_quat_xyzw(row[4:], row[1:4]) for row in table]).reshape(-1, 4, 4)
        steps = [0.0, *(translation_norm(inverse(a) @ b) for a, b in pairwise(poses))]
        way = np.cumsum(steps)[: len(poses)]
        return cls(table[:, 0], poses, way[:, None] * (_SIGMA_M**2, _SIGMA_RAD**2))

    @classmethod
    def _of_increments(cls, table: Array) -> Wheels:
        T_odom_base, poses = np.eye(4), []
        for dx, dy, dyaw in table[:, 1:4]:
            step = make(so3_exp(np.array([0.0, 0.0, dyaw])), np.array([dx, dy, 0.0]))
            T_odom_base = np.asarray(T_odom_base @ step)
            poses.append(T_odom_base)
        return cls(table[:, 0], np.array(poses).reshape(-1, 4, 4), np.cumsum(table[:, 4:] ** 2, axis=0))

    def at(self, stamp: float) -> ExternalOdometry | None:
        """Interpolated to a stamp in seconds; None outside the record."""
        after = int(np.searchsorted(self._stamps, stamp))
        if after < len(self._stamps) and self._stamps[after] == stamp:
            return ExternalOdometry(self._poses[after], self._variances[after])
        if not 0 < after < len(self._stamps):
            return None
        before = after - 1
        fraction = float((stamp - self._stamps[before]) / (self._stamps[after] - self._stamps[before]))
        pose = interpolate(self._poses[before], self._poses[after], fraction)
        variances = (1.0 - fraction) * self._variances[before] + fraction * self._variances[after]
        return ExternalOdometry(pose, variances)
