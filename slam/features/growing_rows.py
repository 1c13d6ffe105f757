"""Rows of words that grow, and are let go, in the same way whatever finds the nearest of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

#: Rows that there is room for at first.
FIRST_ROOM = 1024
Kind = TypeVar("Kind", bound=np.generic)


class GrowingRows(ABC, Generic[Kind]):
    """Descriptors in rows, with room for more.

    Attributes:
        count: rows so far, dead ones included.
        descriptors: (room, D).
        alive: (room,) whether a row is a word.
    """

    def __init__(self, width: int, dtype: type[Kind]) -> None:
        self.count = 0
        self.descriptors: NDArray[Kind] = np.zeros((FIRST_ROOM, width), dtype)
        self.alive = np.zeros(FIRST_ROOM, np.bool_)
        self._stamps: NDArray[np.int32] = np.zeros(FIRST_ROOM, np.int32)
        self._stamp = 0

    @abstractmethod
    def append(self, descriptors: NDArray[Any]) -> None:
        """Takes in these words as they are, in the next rows."""

    @abstractmethod
    def _forget(self) -> None:
        """Nothing is found any more."""

    @abstractmethod
    def _grow(self, room: int) -> None:
        """What finds the nearest gets room for so many rows; the rows themselves have it."""

    def compact(self) -> NDArray[np.int32]:
        """Lets the dead rows go; returns the old row of each new one."""
        kept = np.flatnonzero(self.alive[: self.count]).astype(np.int32)
        descriptors = self.descriptors[kept]
        self.count = 0
        self.alive[:] = False
        self._forget()
        self.append(descriptors)
        return kept

    def _reserve(self, size: int) -> None:
        room = len(self.alive)
        while room < size:
            room *= 2
        more = room - len(self.alive)
        if more:
            self.descriptors = np.pad(self.descriptors, ((0, more), (0, 0)))
            self.alive = np.pad(self.alive, (0, more))
            self._stamps = np.pad(self._stamps, (0, more))
            self._grow(room)
