"""Arrays and poses as the lists that JSON carries."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, Pose, to_quats_xyzw

_DIGITS = 7


def pose_list(T_a_b: Pose | None) -> list[float] | None:
    """``[x, y, z, qx, qy, qz, qw]`` of a pose; None where it is unknown."""
    return None if T_a_b is None else pose_lists(T_a_b[None])[0]


def pose_lists(T_a_b: Array) -> list[list[float] | None]:
    """The same of many poses (N, 4, 4); None for those that are not finite."""
    known: NDArray[np.bool_] = np.asarray(np.isfinite(T_a_b).all(axis=(1, 2)))
    T_a_b = np.where(known[:, None, None], T_a_b, np.eye(4))
    listed = np.column_stack([T_a_b[:, :3, 3], to_quats_xyzw(T_a_b)]).round(_DIGITS).tolist()
    return [pose if ok else None for pose, ok in zip(listed, known.tolist(), strict=True)]


def known_poses(poses: Mapping[int, Pose]) -> dict[int, list[float]]:
    """The same of poses by id, without those that are not finite."""
    listed = pose_lists(np.array(list(poses.values())).reshape(-1, 4, 4))
    return {node_id: pose for node_id, pose in zip(poses, listed, strict=True) if pose is not None}


def number_list(values: NDArray[np.floating], digits: int = 6) -> list[float | None]:
    """Numbers, None for what is not finite; rounded, since nobody reads more digits and each costs a byte."""
    rounded = np.round(np.asarray(values, dtype=np.float64), digits)
    finite = np.isfinite(rounded)
    listed: list[float | None] = rounded.tolist()
    if finite.all():
        return listed
    return [value if known else None for value, known in zip(listed, finite.tolist(), strict=True)]


def number(value: float | None) -> float | None:
    """The number, None when it is not finite."""
    return None if value is None or not np.isfinite(value) else float(value)
