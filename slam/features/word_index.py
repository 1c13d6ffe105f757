"""Nearest words of a binary descriptor, by locality-sensitive hashing (Indyk and Motwani 1998).

Each table keys a word by a few of its bits, drawn at random; a query looks only at the words that share a key with it
in some table. Words are added one by one and never moved; those let go stay in the tables, marked, until ``compact``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.features.growing_rows import FIRST_ROOM, GrowingRows
from slam.features.hamming import FAR, distance, pack
from slam.types import Descriptors

_TABLES = 16
_KEY_BITS = 19
#: Words farther than this many of 256 bits are rarely found by the tables, so that they count as being this far.
HORIZON = 64

Words = NDArray[np.uint64]
Ints = NDArray[np.int32]


class WordIndex(GrowingRows[np.uint64]):
    """Packed descriptors (N, B / 8) in rows, with the tables that find the nearest two of a query."""

    def __init__(self, words: int, *, seed: int) -> None:
        self._bits = np.random.default_rng(seed).integers(0, 64 * words, (_TABLES, _KEY_BITS)).astype(np.int32)
        self._horizon = HORIZON * words // 4
        super().__init__(words, np.uint64)
        self._next: Ints = np.zeros((_TABLES, FIRST_ROOM), np.int32)
        self._heads: Ints = np.full((_TABLES, 1 << _KEY_BITS), -1, np.int32)

    @staticmethod
    def packed(descriptors: Descriptors) -> Words:
        """Descriptors (N, B) uint8 as this index holds them."""
        return pack(np.asarray(descriptors, np.uint8))

    def unpacked(self, rows: Sequence[int] | slice) -> Descriptors:
        """Descriptors (N, B) uint8 of these rows."""
        return self.descriptors[rows].view(np.uint8)

    def assign(self, descriptors: Words, ratio: float, *, learn: bool, together: bool) -> Ints:
        """Row of each descriptor's word; -1 where there is none and ``learn`` is off.

        Args:
            descriptors: (N, B / 8) packed.
            ratio: largest ratio of nearest to second nearest distance of a known word.
            learn: whether an unknown descriptor becomes a word.
            together: whether descriptors are compared with the words that earlier ones of this call became.
        """
        self._reserve(self.count + len(descriptors))
        known = self.count if not together else 1 << 30
        rows, self.count, self._stamp = _assign(
            descriptors,
            self.descriptors,
            self.alive,
            self._next,
            self._heads,
            self._bits,
            self._stamps,
            self._stamp,
            self.count,
            known,
            ratio,
            learn,
            self._horizon,
        )
        return np.asarray(rows)

    def append(self, descriptors: Words) -> None:
        """Takes in these words as they are, in the next rows."""
        self._reserve(self.count + len(descriptors))
        _insert_all(descriptors, self.count, self.descriptors, self.alive, self._next, self._heads, self._bits)
        self.count += len(descriptors)

    def _forget(self) -> None:
        self._heads[:] = -1

    def _grow(self, room: int) -> None:
        self._next = np.pad(self._next, ((0, 0), (0, room - self._next.shape[1])))


@njit(cache=True, nogil=True)
def _key(descriptor: Words, bits: Ints) -> int:
    key = 0
    for b in bits:
        key = (key << 1) | int((descriptor[b >> 6] >> np.uint64(b & 63)) & np.uint64(1))
    return key


@njit(cache=True, nogil=True)
def _insert(
    descriptor: Words, row: int, words: Words, alive: NDArray[np.bool_], chain: Ints, heads: Ints, bits: Ints
) -> None:
    words[row] = descriptor
    alive[row] = True
    for table in range(len(bits)):
        key = _key(descriptor, bits[table])
        chain[table, row] = heads[table, key]
        heads[table, key] = row


@njit(cache=True, nogil=True)
def _insert_all(
    descriptors: Words, first: int, words: Words, alive: NDArray[np.bool_], chain: Ints, heads: Ints, bits: Ints
) -> None:
    for k in range(len(descriptors)):
        _insert(descriptors[k], first + k, words, alive, chain, heads, bits)


@njit(cache=True, nogil=True)
def _assign(
    descriptors: Words,
    words: Words,
    alive: NDArray[np.bool_],
    chain: Ints,
    heads: Ints,
    bits: Ints,
    stamps: Ints,
    stamp: int,
    count: int,
    known: int,
    ratio: float,
    learn: bool,
    horizon: int,
) -> tuple[Ints, int, int]:
    rows = np.empty(len(descriptors), np.int32)
    for i in range(len(descriptors)):
        stamp += 1
        best, second, best_row = FAR, horizon, -1
        for table in range(len(bits)):
            row = heads[table, _key(descriptors[i], bits[table])]
            while row >= 0:
                if stamps[row] != stamp and alive[row] and row < known:
                    stamps[row] = stamp
                    d = distance(descriptors[i], words[row])
                    if d < best:
                        second = min(second, best)
                        best, best_row = d, row
                    elif d < second:
                        second = d
                row = chain[table, row]
        rows[i] = best_row if best <= ratio * second else -1
        if rows[i] < 0 and learn:
            _insert(descriptors[i], count, words, alive, chain, heads, bits)
            rows[i] = count
            count += 1
    return rows, count, stamp
