"""The clock of one update: how long each of its stages took, under RTAB-Map's names."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


class StageClock:
    """Collects ``Timing/.../ms`` values; starts when it is made."""

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self.values: dict[str, float] = {}

    @property
    def elapsed_ms(self) -> float:
        """Milliseconds since the start."""
        return (time.perf_counter() - self._start) * 1e3

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Times a block as ``name``; blocks of the same name add up."""
        start = time.perf_counter()
        try:
            yield
        finally:
            spent = (time.perf_counter() - start) * 1e3
            self.values[name] = self.values.get(name, 0.0) + spent
