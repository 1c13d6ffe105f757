"""Removing a map file on request, and nothing else of that name."""

from __future__ import annotations

from pathlib import Path

from slam.database.file_reader import FileReader
from slam.database.lock import MapLock
from slam.database.refusal import refusing


def remove_map(path: Path) -> None:
    """Remove a map file with its log; nothing happens where there is none.

    Raises:
        DatabaseError: what is there is no map, or can't be removed.
        MapBusyError: somebody is writing it.
    """
    if not path.exists():
        return
    lock = MapLock(path)
    try:
        # Whatever can't be read as a map may be anything, and stays.
        FileReader(path)
        with refusing(path, "removing the map"):
            for suffix in ("", "-wal", "-shm"):
                path.with_name(path.name + suffix).unlink(missing_ok=True)
    finally:
        lock.release()
