"""Distances between binary descriptors, packed as 64-bit words."""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

#: Larger than any distance between descriptors of 256 bits.
FAR = 1 << 20


@intrinsic
def _popcount_instruction(_context: Any, _word: Any) -> Any:
    """Number of set bits of a 64-bit word, one machine instruction."""

    def build(_codegen_context: Any, builder: Any, _signature: Any, args: Any) -> ir.Value:
        return builder.ctpop(args[0])

    return types.uint64(types.uint64), build


#: Typed as what compiled code calls it with; the decorator keeps the typing context's argument in the signature.
_popcount: Any = _popcount_instruction


def pack(descriptors: NDArray[np.uint8]) -> NDArray[np.uint64]:
    """Descriptors (N, B) uint8, B a multiple of 8, as (N, B / 8) words."""
    return np.ascontiguousarray(descriptors).view(np.uint64)


@njit(cache=True, nogil=True)
def distance(a: NDArray[np.uint64], b: NDArray[np.uint64]) -> int:
    """Hamming distance of two packed descriptors."""
    total = 0
    for k in range(a.shape[0]):
        total += _popcount(a[k] ^ b[k])
    return total
