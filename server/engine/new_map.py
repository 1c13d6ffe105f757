"""The new map file of a run."""

from __future__ import annotations

from pathlib import Path

from slam.database import MapWriter
from slam.database.lock import MapLock
from slam.errors import DatabaseError
from slam.params import Params


def create_map(path: Path, params: Params, *, seed: int, source: str, overwrite: bool) -> MapWriter:
    """Make a map file and begin its first session.

    Raises:
        DatabaseError: the file exists and may not be replaced, is no map, or can't be made.
        MapBusyError: somebody writes it.
    """
    if overwrite and path.exists():
        _remove(path)
    return MapWriter.create(path, params, seed=seed, source=source)


def _remove(path: Path) -> None:
    lock = MapLock(path)
    try:
        for part in (path, *(path.with_name(path.name + end) for end in ("-wal", "-shm"))):
            part.unlink(missing_ok=True)
    except OSError as error:
        raise DatabaseError(f"{path} can't be replaced: {error.strerror}") from error
    finally:
        lock.release()
