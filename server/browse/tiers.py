"""Which memory every node of a file is in."""

from __future__ import annotations

from server.browse.moves import Move, recorded_moves
from slam.database import Faults, MapReader
from slam.types import Tier


class TierLog:
    """Follows the moves between memories that a map's updates record, reading only what is new."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._last = 0
        self._recorded: dict[int, Tier] = {}
        self._moves: list[Move] = []

    def read(self, faults: Faults) -> dict[int, Tier]:
        """Id -> tier; for files that record no moves, working memory is what RTAB-Map would load into it.

        Updates that make no sense go to ``faults``.
        """
        new = recorded_moves(self._reader.updates(after=self._last, faults=faults))
        for move in new:
            self._recorded.update(move.tiers)
            self._last = move.id
        self._moves.extend(new)
        if self._recorded:
            return dict(self._recorded)
        return dict.fromkeys(self._reader.memory_node_ids().tolist(), Tier.WM)

    def moves(self) -> list[Move]:
        """The moves that were read so far, oldest first; none for files that record none."""
        return list(self._moves)
