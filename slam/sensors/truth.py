"""Ground truth between its samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.errors import SourceError
from slam.geometry import Pose, from_quat_xyzw, interpolate
from slam.sensors.lists import read_table

#: Samples farther apart than this are not interpolated: the tracker had lost the camera.
MAX_GAP_S = 0.05
#: A sample this close is the frame's own; stamps are rounded when they are written.
SAME_S = 1e-4
_COLUMNS = "stamp tx ty tz qx qy qz qw"


class Truth:
    """Poses T_world_cam of the optical frame at ascending stamps."""

    def __init__(self, stamps: NDArray[np.float64], positions: NDArray[np.float64], quats_xyzw: NDArray[np.float64]):
        self._stamps = stamps
        self._positions = positions
        self._quats_xyzw = quats_xyzw

    @classmethod
    def read(cls, path: Path) -> Truth:
        """Truth of a groundtruth.txt; empty when there is no such file.

        Raises:
            SourceError: a line is not ``stamp tx ty tz qx qy qz qw``, or a quaternion has no length.
        """
        table = read_table(path, _COLUMNS) if path.exists() else np.empty((0, 8))
        lengths = np.linalg.norm(table[:, 4:], axis=1)
        bad = np.flatnonzero(np.abs(lengths - 1.0) > 0.05)
        if len(bad):
            raise SourceError(
                f"{path}: quaternion of length {lengths[bad[0]]:.3g} at stamp {table[bad[0], 0]:.6f}; "
                f"expected 1 (`{_COLUMNS}`)"
            )
        return cls(table[:, 0], table[:, 1:4], table[:, 4:])

    def __len__(self) -> int:
        return len(self._stamps)

    def at(self, stamp: float) -> Pose | None:
        """T_world_cam at a stamp in seconds; None outside the record and inside a gap of more than 50 ms."""
        after = int(np.searchsorted(self._stamps, stamp))
        for row in (after - 1, after):
            if 0 <= row < len(self._stamps) and abs(self._stamps[row] - stamp) <= SAME_S:
                return self._sample(row)
        if not 0 < after < len(self._stamps):
            return None
        gap = self._stamps[after] - self._stamps[after - 1]
        if gap > MAX_GAP_S:
            return None
        fraction = float((stamp - self._stamps[after - 1]) / gap)
        return interpolate(self._sample(after - 1), self._sample(after), fraction)

    def _sample(self, row: int) -> Pose:
        return from_quat_xyzw(self._quats_xyzw[row], self._positions[row])
