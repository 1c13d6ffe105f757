"""How far poses moved from one state of a graph to another, and states kept to go back to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, Pose, inverse

#: A pose that moved less than both did not move.
MOVED_M = 0.001
MOVED_RAD = float(np.radians(0.05))


@dataclass(frozen=True, slots=True)
class Shift:
    """Number of poses that moved by more than 1 mm or 0.05 deg, and the farthest that one moved in metres."""

    moved: int
    max_m: float

    @classmethod
    def between(cls, before: Mapping[int, Pose], after: Mapping[int, Pose]) -> Shift:
        """The shift of the nodes that both states have."""
        ids = [i for i in before if i in after]
        if not ids:
            return cls(0, 0.0)
        T_before, T_after = (np.array([poses[i] for i in ids]) for poses in (before, after))
        metres = np.linalg.norm(T_after[:, :3, 3] - T_before[:, :3, 3], axis=1)
        radians = angles(inverse(T_before) @ T_after)
        return cls(int(((metres > MOVED_M) | (radians > MOVED_RAD)).sum()), float(metres.max()))


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """All poses of a graph at one moment, to the last bit: ids (N,) and poses (N, 4, 4)."""

    ids: tuple[int, ...]
    T_map_base: NDArray[np.float64]

    @classmethod
    def of(cls, poses: Mapping[int, Pose]) -> Snapshot:
        """Keep these poses."""
        return cls(tuple(poses), np.array(list(poses.values()), dtype=np.float64).reshape(-1, 4, 4))

    def same(self, poses: Mapping[int, Pose]) -> bool:
        """Whether these poses are the ones kept, bit for bit."""
        return self.ids == tuple(poses) and np.array_equal(self.T_map_base, Snapshot.of(poses).T_map_base)

    def poses(self) -> dict[int, Pose]:
        """The poses kept."""
        return dict(zip(self.ids, self.T_map_base, strict=True))


def angles(T: Array) -> Array:
    """Rotation angles (N,) in [0, pi] of poses (N, 4, 4), exact for small ones too."""
    R = T[:, :3, :3]
    axis = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    return np.asarray(np.arctan2(np.linalg.norm(axis, axis=1), np.trace(R, axis1=1, axis2=2) - 1.0))
