"""What an index of visual words can do, and the one that fits a kind of descriptor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from slam.features.float_index import FloatIndex
from slam.features.word_index import WordIndex
from slam.types import Descriptors

_BYTES_PER_PACKED = 8


class Index(Protocol):
    """Words in rows that are never moved but by ``compact``; ``alive`` marks those in use."""

    count: int
    alive: NDArray[np.bool_]

    def packed(self, descriptors: Descriptors) -> NDArray[Any]:
        """Descriptors (N, B) as this index holds them."""
        ...

    def unpacked(self, rows: Sequence[int] | slice) -> Descriptors:
        """Descriptors (N, B) of these rows."""
        ...

    def assign(self, descriptors: NDArray[Any], ratio: float, *, learn: bool, together: bool) -> NDArray[np.int32]:
        """Row of the word of each packed descriptor; -1 where there is none and ``learn`` is off."""
        ...

    def append(self, descriptors: NDArray[Any]) -> None:
        """Takes in packed descriptors as words, in the next rows."""
        ...

    def compact(self) -> NDArray[np.int32]:
        """Lets the dead rows go; returns the old row of each new one."""
        ...


def index_for(descriptors: Descriptors, *, seed: int) -> Index:
    """An empty index for descriptors (N, B) of this kind."""
    width = descriptors.shape[1]
    if descriptors.dtype == np.float32:
        return FloatIndex(width, seed=seed)
    return WordIndex(width // _BYTES_PER_PACKED, seed=seed)
