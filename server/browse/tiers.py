"""Which memory every node of a file is in."""

from __future__ import annotations

from slam.database import MapReader
from slam.types import Tier


class TierLog:
    """Follows the moves between memories that a map's updates record, reading only what is new."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._last = 0
        self._recorded: dict[int, Tier] = {}

    def read(self) -> dict[int, Tier]:
        """Id -> tier; for files that record no moves, working memory is what RTAB-Map would load into it."""
        for update in self._reader.updates(after=self._last):
            self._recorded.update(update.tiers)
            self._last = update.id
        if self._recorded:
            return dict(self._recorded)
        node_ids, _ = self._reader.memory_ids()
        return dict.fromkeys(node_ids.tolist(), Tier.WM)
