"""Arrays and poses as the lists that JSON carries."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, to_quat_xyzw


def pose_list(T_a_b: Pose | None) -> list[float] | None:
    """``[x, y, z, qx, qy, qz, qw]`` of a pose; None where it is unknown."""
    if T_a_b is None or not np.isfinite(T_a_b).all():
        return None
    return [round(float(v), 7) for v in (*T_a_b[:3, 3], *to_quat_xyzw(T_a_b))]


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
