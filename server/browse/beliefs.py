"""What the updates believed, kept in memory: each is read once."""

from __future__ import annotations

import threading

from slam.database import MapReader
from slam.types import Posterior


class BeliefLog:
    """The beliefs over places of all updates of a map; what comes later is read when it is asked for."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._lock = threading.Lock()
        self._known: dict[int, Posterior] = {}
        self._newest = 0

    def at(self, update_id: int) -> Posterior | None:
        """The belief after an update; None where it had none, or none is stored."""
        with self._lock:
            if update_id > self._newest:
                self._known |= self._reader.beliefs(self._newest)
                self._newest = max([update_id, *self._known])
            return self._known.get(update_id)
