"""Distances between descriptors in compiled code: Hamming for packed binary ones, squared L2 for float ones."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numba.core import types
from numba.extending import overload
from numpy.typing import NDArray

from slam.features import hamming


def distance(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Hamming distance of two packed descriptors (uint64), or squared L2 of two float32 ones."""
    return float(hamming.distance(a, b) if a.dtype == np.uint64 else squared_l2(a, b))


# The order of summing is free, so that it is done in lanes: the same machine gives the same sum every time.
@njit(cache=True, fastmath={"reassoc", "contract"})
def squared_l2(a: NDArray[np.float32], b: NDArray[np.float32]) -> float:
    """Squared Euclidean distance."""
    total = np.float32(0.0)
    for k in range(a.shape[0]):
        off = a[k] - b[k]
        total += off * off
    return total  # type: ignore[return-value]  # compiled code has one kind of float


@overload(distance)
def _distance(a: Any, b: Any) -> Any:
    chosen = hamming.distance if a.dtype == b.dtype == types.uint64 else squared_l2

    def compiled(a: Any, b: Any) -> Any:
        return chosen(a, b)

    return compiled
