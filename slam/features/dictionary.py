"""The incremental visual dictionary: words are made from descriptors that resemble no word yet."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from slam.features.index import Index, index_for
from slam.features.kind import check_kind
from slam.params import Params
from slam.types import Descriptors


class Dictionary:
    """Words in RAM with the number of nodes that use each; words no node uses are let go."""

    def __init__(self, *, seed: int) -> None:
        self._seed = seed
        self._index: Index | None = None
        self._ids = np.zeros(0, np.int32)
        self._rows: dict[int, int] = {}
        self._uses: dict[int, int] = {}
        self._next_id = 1

    def __len__(self) -> int:
        return len(self._rows)

    def ids(self) -> list[int]:
        """Ids of the words in RAM, ascending."""
        return sorted(self._rows)

    def descriptors(self, ids: NDArray[np.int32]) -> Descriptors:
        """Descriptors (N, B) of words in RAM."""
        if self._index is None:
            return np.zeros((0, 0), np.uint8)
        return self._index.unpacked([self._rows[word] for word in ids.tolist()])

    def quantize(
        self, descriptors: Descriptors, params: Params
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], Descriptors]:
        """Word ids (N,) of descriptors (N, B); and the ids and descriptors of the words made for them.

        Raises:
            ParameterError: the descriptors are of another kind than the words.
        """
        if len(descriptors) == 0:
            return np.zeros(0, np.int32), np.zeros(0, np.int32), descriptors
        index = self._index_of(descriptors)
        before = index.count
        rows = index.assign(
            index.packed(descriptors), params.Kp.NndrRatio, learn=True, together=params.Kp.NewWordsComparedTogether
        )
        created = index.count - before
        new_ids = np.arange(self._next_id, self._next_id + created, dtype=np.int32)
        self._next_id += created
        self._register(new_ids, before)
        return self._ids[rows], new_ids, index.unpacked(slice(before, index.count)).copy()

    def absent(self, ids: Iterable[int]) -> list[int]:
        """Those of these words that are not in RAM, ascending."""
        return sorted(word for word in ids if word not in self._rows)

    def restore(self, ids: NDArray[np.int32], descriptors: Descriptors, params: Params) -> dict[int, int]:
        """Brings back words of a node from long-term memory.

        A word that resembles one in RAM becomes that one; the others come back under their own id.

        Returns:
            Old id -> id in RAM.
        """
        missing = np.array([i for i, word in enumerate(ids.tolist()) if word not in self._rows], np.int64)
        renamed = {word: word for word in ids.tolist()}
        if len(missing) == 0:
            return renamed
        index = self._index_of(descriptors)
        packed = index.packed(descriptors[missing])
        rows = index.assign(packed, params.Kp.NndrRatio, learn=False, together=False)
        for row, word in zip(rows.tolist(), ids[missing].tolist(), strict=True):
            if row >= 0:
                renamed[word] = int(self._ids[row])
        unknown = rows < 0
        before = index.count
        index.append(packed[unknown])
        self._register(ids[missing][unknown], before)
        self._next_id = max(self._next_id, int(ids.max()) + 1)
        return renamed

    def adopt(self, ids: NDArray[np.int32], descriptors: Descriptors) -> None:
        """Takes in words (N,), (N, B) under their own ids, those that are not in RAM already."""
        missing = np.array([i for i, word in enumerate(ids.tolist()) if word not in self._rows], np.int64)
        if len(missing):
            index = self._index_of(descriptors)
            before = index.count
            index.append(index.packed(descriptors[missing]))
            self._register(ids[missing], before)
            self._next_id = max(self._next_id, int(ids.max()) + 1)

    def load(self, ids: NDArray[np.int32], descriptors: Descriptors, next_id: int) -> None:
        """Takes in the words of a map file (N,), (N, B) under their own ids, into an empty dictionary.

        ``next_id`` is the first id that no word of the file has, in RAM or not.
        """
        self._next_id = next_id
        if len(ids):
            index = self._index_of(descriptors)
            index.append(index.packed(descriptors))
            self._register(ids, 0)

    def use(self, ids: Iterable[int]) -> None:
        """One more node has these words."""
        for word in ids:
            self._uses[word] = self._uses.get(word, 0) + 1

    def release(self, ids: Iterable[int]) -> None:
        """One node less has these words; those without any are let go."""
        index = self._index
        if index is None:
            return
        for word in ids:
            left = self._uses.get(word, 0) - 1
            if left > 0:
                self._uses[word] = left
            else:
                self._uses.pop(word, None)
                index.alive[self._rows.pop(word)] = False
        if index.count > 4096 and 2 * len(self._rows) < index.count:
            self._ids = self._ids[index.compact()]
            self._rows = {word: row for row, word in enumerate(self._ids.tolist())}

    def discard(self, ids: Iterable[int]) -> None:
        """A node with these words is not kept: those that were made for it go again."""
        words = list(ids)
        self.use(words)
        self.release(words)

    def _index_of(self, descriptors: Descriptors) -> Index:
        """The index of the words; the first descriptors decide which kind it is."""
        if self._index is None:
            self._index = index_for(descriptors, seed=self._seed)
        check_kind(self._index.unpacked(slice(0, 0)), descriptors)
        return self._index

    def _register(self, ids: NDArray[np.int32], first_row: int) -> None:
        self._ids = np.concatenate([self._ids, ids])
        self._rows.update((word, first_row + k) for k, word in enumerate(ids.tolist()))
