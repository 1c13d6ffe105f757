"""How far a map's trajectory is from ground truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from slam.evaluate import absolute_error
from slam.geometry import Pose
from slam.trajectory import assemble
from slam.types import TrackedFrame

#: Fewer positions can't be aligned.
_LEAST = 3


def frames_ate_m(frames: Sequence[TrackedFrame], poses: Mapping[int, Pose]) -> float | None:
    """Absolute trajectory error in metres of all tracked frames, SE(3)-aligned; None without ground truth."""
    path = assemble(frames, poses)
    return poses_ate_m(path.T_world_base, path.T_map_base)


def poses_ate_m(T_world_base: NDArray[np.float64], T_map_base: NDArray[np.float64]) -> float | None:
    """The same of poses (N, 4, 4); those with NaN for truth are left out."""
    known = np.isfinite(T_world_base[:, 0, 3])
    if known.sum() < _LEAST:
        return None
    return absolute_error(T_world_base[known], T_map_base[known]).rmse_m
