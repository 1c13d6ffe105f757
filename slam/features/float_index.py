"""Nearest words of a float descriptor, by a forest of k-d trees.

Words are added one by one and never moved; those let go stay in their leaves, marked, until ``compact``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam.features import forest
from slam.features.growing_rows import FIRST_ROOM, GrowingRows
from slam.types import Descriptors

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]


class FloatIndex(GrowingRows[np.float32]):
    """Descriptors (N, D) float32 in rows, with the trees that find the nearest two of a query."""

    def __init__(self, width: int, *, seed: int) -> None:
        self._random = np.array([seed % (1 << 32) + 1], np.uint64)
        super().__init__(width, np.float32)
        self._trees = forest.planted(FIRST_ROOM)

    @staticmethod
    def packed(descriptors: Descriptors) -> Floats:
        """Descriptors (N, D) float32 as this index holds them."""
        return np.ascontiguousarray(descriptors, np.float32)

    def unpacked(self, rows: Sequence[int] | slice) -> Descriptors:
        """Descriptors (N, D) float32 of these rows."""
        return self.descriptors[rows]

    def assign(self, descriptors: Floats, ratio: float, *, learn: bool, together: bool) -> Ints:
        """Row of each descriptor's word; -1 where there is none and ``learn`` is off.

        Args:
            descriptors: (N, D).
            ratio: largest ratio of nearest to second nearest squared distance of a known word; one word alone is
                never known, as in RTAB-Map. Infinity takes the nearest, whatever the second is.
            learn: whether an unknown descriptor becomes a word.
            together: whether descriptors are compared with the words that earlier ones of this call became.
        """
        self._reserve(self.count + len(descriptors))
        known = self.count if not together else 1 << 30
        rows, self.count, self._stamp = forest.assign(
            descriptors,
            self.descriptors,
            self.alive,
            self._trees,
            self._stamps,
            self._stamp,
            self.count,
            known,
            ratio,
            learn,
            self._random,
        )
        return np.asarray(rows)

    def append(self, descriptors: Floats) -> None:
        """Takes in these words as they are, in the next rows."""
        self._reserve(self.count + len(descriptors))
        forest.insert_all(descriptors, self.count, self.descriptors, self.alive, self._trees, self._random)
        self.count += len(descriptors)

    def _forget(self) -> None:
        self._trees = forest.planted(len(self.alive))

    def _grow(self, room: int) -> None:
        self._trees = forest.grown(self._trees, room)
