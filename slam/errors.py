"""One tree for everything slamdeck refuses; the edge (CLI or API) turns it into one line or one JSON shape."""

from __future__ import annotations


class SlamError(Exception):
    """Something was refused. The message names what, where, and what would be right."""


class SourceError(SlamError):
    """A sensor source (folder, image, calibration) can't be used."""


class ParameterError(SlamError):
    """A parameter is unknown, of the wrong type, out of bounds, or can't change now."""


class DatabaseError(SlamError):
    """A map file can't be opened, read or written."""


class DamagedRowError(DatabaseError):
    """A row of a map file can't be understood; the others can.

    Attributes:
        table: of the file.
        row: its id, or the ids that name it.
        reason: what is wrong with it.
    """

    def __init__(self, table: str, row: str, reason: str, context: str = "") -> None:
        super().__init__(f"{context}{table}, row {row}: {reason}")
        self.table = table
        self.row = row
        self.reason = reason


class MapBusyError(DatabaseError):
    """Another writer holds the map file."""


class DecisionError(SlamError):
    """A decision about a link can't be carried out on this graph."""


class OptimizationError(SlamError):
    """The pose graph can't be optimised (disconnected from the root, invalid information, solver failure)."""
