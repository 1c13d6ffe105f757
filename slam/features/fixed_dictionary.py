"""A dictionary whose words are given: every descriptor is its nearest word, and none is made."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.database import WordRows
from slam.errors import ParameterError
from slam.features.hamming import FAR, distance, pack
from slam.features.index import index_for
from slam.features.kind import check_kind
from slam.params import Params
from slam.types import Descriptors


class FixedDictionary:
    """Words of a file, with the number of nodes in RAM that use each.

    Args:
        words: all of them.
        stored: ids of those that the map file has.
        seed: of the index.
    """

    def __init__(self, words: WordRows, *, stored: Collection[int] = (), seed: int = 0) -> None:
        self._words = words
        self._rows = {word: row for row, word in enumerate(words.ids.tolist())}
        self._uses: dict[int, int] = {}
        self._stored = set(stored)
        self._index = index_for(words.descriptors, seed=seed)
        if words.descriptors.dtype == np.float32:
            self._index.append(self._index.packed(words.descriptors))

    def __len__(self) -> int:
        return len(self._words)

    def ids(self) -> list[int]:
        """Ids of the words that nodes in RAM use, ascending."""
        return sorted(self._uses)

    def descriptors(self, ids: NDArray[np.int32]) -> Descriptors:
        """Descriptors (N, B) of words."""
        return self._words.descriptors[[self._rows[word] for word in ids.tolist()]]

    def quantize(
        self, descriptors: Descriptors, params: Params
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], Descriptors]:
        """Word ids (N,) of descriptors (N, B); and the ids and descriptors of those that the map file lacks yet.

        Raises:
            ParameterError: the descriptors are of another kind than the words.
        """
        del params  # no ratio decides: the nearest word is always right
        if len(descriptors) == 0:
            return np.zeros(0, np.int32), np.zeros(0, np.int32), descriptors
        check_kind(self._words.descriptors, descriptors)
        words = self._words.ids[self._nearest(descriptors)]
        fresh = np.array([w for w in np.unique(words).tolist() if w not in self._stored], np.int32)
        return words, fresh, self.descriptors(fresh)

    def load(self, ids: NDArray[np.int32], descriptors: Descriptors, next_id: int) -> None:
        """The words (N,) of a map file that a session goes on with are there already.

        Raises:
            ParameterError: they are of another dictionary.
        """
        del descriptors, next_id
        self._check(ids)

    def absent(self, ids: Iterable[int]) -> list[int]:
        """Those of these words that are not known to be stored, ascending."""
        return sorted(word for word in ids if word not in self._stored)

    def restore(self, ids: NDArray[np.int32], descriptors: Descriptors, params: Params) -> dict[int, int]:
        """Words of a node that comes back are there already.

        Raises:
            ParameterError: they are of another dictionary.
        """
        del descriptors, params
        self._check(ids)
        self._stored.update(ids.tolist())
        return {word: word for word in ids.tolist()}

    def use(self, ids: Iterable[int]) -> None:
        """One more node, which is stored, has these words."""
        for word in ids:
            self._uses[word] = self._uses.get(word, 0) + 1
            self._stored.add(word)

    def release(self, ids: Iterable[int]) -> None:
        """One node less has these words."""
        for word in ids:
            left = self._uses.pop(word) - 1
            if left > 0:
                self._uses[word] = left

    def discard(self, ids: Iterable[int]) -> None:
        """A node with these words is not kept, nor stored: nothing changes."""

    def _check(self, ids: NDArray[np.int32]) -> None:
        unknown = [word for word in ids.tolist() if word not in self._rows]
        if unknown:
            raise ParameterError(f"word {unknown[0]} of the map is not in Kp/DictionaryPath: use the map's dictionary")

    def _nearest(self, descriptors: Descriptors) -> NDArray[np.int32]:
        if descriptors.dtype == np.float32:
            packed = self._index.packed(descriptors)
            return self._index.assign(packed, np.inf, learn=False, together=False)
        # Words of other places are often farther than hashing can find: all are looked at.
        return np.asarray(_nearest_of_all(pack(np.asarray(descriptors)), pack(np.asarray(self._words.descriptors))))


@njit(cache=True, nogil=True)
def _nearest_of_all(descriptors: NDArray[np.uint64], words: NDArray[np.uint64]) -> NDArray[np.int32]:
    rows = np.empty(len(descriptors), np.int32)
    for i in range(len(descriptors)):
        best = FAR
        for j in range(len(words)):
            d = distance(descriptors[i], words[j])
            if d < best:
                best = d
                rows[i] = j
    return rows
