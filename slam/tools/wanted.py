"""Parameters that somebody wants to try on a map."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from slam.database import MapReader
from slam.errors import ParameterError
from slam.params import Params, Value
from slam.tools.parameters import taken

#: What decides how frames are tracked; a replay has odometry as it was stored.
_TRACKING = ("Odom/", "OdomF2M/")


@dataclass(frozen=True, slots=True, eq=False)
class Wanted:
    """Parameters to try on a map.

    Attributes:
        path: of the map file; it stays as it is.
        changes: what is tried.
        base: values in force that the file does not tell, because the engine that writes it was told since.
    """

    path: Path
    changes: Mapping[str, Value]
    base: Mapping[str, Value]


def check(wanted: Wanted) -> tuple[Params, Params]:
    """The parameters of the map, and those of the trial.

    Raises:
        ParameterError: one is unknown or out of bounds, decides what a replay does not repeat, or nothing would change.
        DatabaseError: the file can't be read.
    """
    before = taken(MapReader(wanted.path)).params.changed(wanted.base)
    after = before.changed(wanted.changes)
    for name in wanted.changes:
        if name.startswith(_TRACKING):
            raise ParameterError(
                f"{name} decides how frames are tracked, and a trial has odometry as it was stored: leave it out, and "
                "try it by a new run or `slamdeck reprocess --odometry own`"
            )
    if "Mem/IncrementalMemory" in wanted.changes and not after.Mem.IncrementalMemory:
        raise ParameterError("Mem/IncrementalMemory false would make no map: a trial makes one")
    if all(after.get(name) == before.get(name) for name in wanted.changes):
        raise ParameterError("nothing would change: give at least one parameter another value than it has")
    return before, after
