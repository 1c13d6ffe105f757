"""Nearest words of a float descriptor, by a forest of k-d trees.

Words are added one by one and never moved; those let go stay in their leaves, marked, until ``compact``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam.features import forest
from slam.types import Descriptors

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]


class FloatIndex:
    """Descriptors (N, D) float32 in rows, with the trees that find the nearest two of a query."""

    def __init__(self, width: int, *, seed: int) -> None:
        self._random = np.array([seed % (1 << 32) + 1], np.uint64)
        self.count = 0
        self.descriptors: Floats = np.zeros((1024, width), np.float32)
        self.alive = np.zeros(1024, np.bool_)
        self._trees = forest.planted(1024)
        self._stamps: Ints = np.zeros(1024, np.int32)
        self._stamp = 0

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

    def compact(self) -> Ints:
        """Lets the dead rows go; returns the old row of each new one."""
        kept = np.flatnonzero(self.alive[: self.count]).astype(np.int32)
        descriptors = self.descriptors[kept]
        self.count = 0
        self.alive[:] = False
        self._trees = forest.planted(len(self.alive))
        self.append(descriptors)
        return kept

    def _reserve(self, size: int) -> None:
        grown = len(self.alive)
        while grown < size:
            grown *= 2
        if grown > len(self.alive):
            more = grown - len(self.alive)
            self.descriptors = np.pad(self.descriptors, ((0, more), (0, 0)))
            self.alive = np.pad(self.alive, (0, more))
            self._stamps = np.pad(self._stamps, (0, more))
            self._trees = forest.grown(self._trees, grown)
