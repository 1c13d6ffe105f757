"""The incremental visual dictionary: words are made from descriptors that resemble no word yet."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from slam.features.hamming import pack
from slam.features.word_index import WordIndex
from slam.params import Params

#: Length of a descriptor.
WORD_BYTES = 32


class Dictionary:
    """Words in RAM with the number of nodes that use each; words no node uses are let go."""

    def __init__(self, *, seed: int) -> None:
        self._index = WordIndex(WORD_BYTES // 8, seed=seed)
        self._ids = np.zeros(0, np.int32)
        self._rows: dict[int, int] = {}
        self._uses: dict[int, int] = {}
        self._next_id = 1

    def __len__(self) -> int:
        return len(self._rows)

    def ids(self) -> list[int]:
        """Ids of the words in RAM, ascending."""
        return sorted(self._rows)

    def descriptors(self, ids: NDArray[np.int32]) -> NDArray[np.uint8]:
        """Descriptors (N, 32) of words in RAM."""
        rows = [self._rows[word] for word in ids.tolist()]
        return self._index.descriptors[rows].view(np.uint8)

    def quantize(
        self, descriptors: NDArray[np.uint8], params: Params
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.uint8]]:
        """Word ids (N,) of descriptors (N, 32); and the ids and descriptors of the words made for them."""
        before = self._index.count
        rows = self._index.assign(
            pack(descriptors), params.Kp.NndrRatio, learn=True, together=params.Kp.NewWordsComparedTogether
        )
        created = self._index.count - before
        new_ids = np.arange(self._next_id, self._next_id + created, dtype=np.int32)
        self._next_id += created
        self._register(new_ids, before)
        new_descriptors = self._index.descriptors[before : self._index.count].view(np.uint8)
        return self._ids[rows], new_ids, new_descriptors.copy()

    def restore(self, ids: NDArray[np.int32], descriptors: NDArray[np.uint8], params: Params) -> dict[int, int]:
        """Brings back words of a node from long-term memory.

        A word that resembles one in RAM becomes that one; the others come back under their own id.

        Returns:
            Old id -> id in RAM.
        """
        missing = np.array([i for i, word in enumerate(ids.tolist()) if word not in self._rows], np.int64)
        renamed = {word: word for word in ids.tolist()}
        if len(missing) == 0:
            return renamed
        packed = pack(descriptors[missing])
        rows = self._index.assign(packed, params.Kp.NndrRatio, learn=False, together=False)
        for row, word in zip(rows.tolist(), ids[missing].tolist(), strict=True):
            if row >= 0:
                renamed[word] = int(self._ids[row])
        unknown = rows < 0
        before = self._index.count
        self._index.append(packed[unknown])
        self._register(ids[missing][unknown], before)
        self._next_id = max(self._next_id, int(ids.max()) + 1)
        return renamed

    def load(self, ids: NDArray[np.int32], descriptors: NDArray[np.uint8], next_id: int) -> None:
        """Takes in the words of a map file (N,), (N, 32) under their own ids, into an empty dictionary.

        ``next_id`` is the first id that no word of the file has, in RAM or not.
        """
        self._index.append(pack(descriptors))
        self._register(ids, 0)
        self._next_id = next_id

    def use(self, ids: Iterable[int]) -> None:
        """One more node has these words."""
        for word in ids:
            self._uses[word] = self._uses.get(word, 0) + 1

    def release(self, ids: Iterable[int]) -> None:
        """One node less has these words; those without any are let go."""
        for word in ids:
            left = self._uses.get(word, 0) - 1
            if left > 0:
                self._uses[word] = left
            else:
                self._uses.pop(word, None)
                self._index.alive[self._rows.pop(word)] = False
        if self._index.count > 4096 and 2 * len(self._rows) < self._index.count:
            self._ids = self._ids[self._index.compact()]
            self._rows = {word: row for row, word in enumerate(self._ids.tolist())}

    def _register(self, ids: NDArray[np.int32], first_row: int) -> None:
        self._ids = np.concatenate([self._ids, ids])
        self._rows.update((word, first_row + k) for k, word in enumerate(ids.tolist()))
