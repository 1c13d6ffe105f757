"""Removing a map file on request, and nothing else of that name."""

from __future__ import annotations

from pathlib import Path

from slam.database.file_check import check_file
from slam.database.lock import MapLock
from slam.errors import DatabaseError


def remove_map(path: Path) -> None:
    """Remove a map file with its log; nothing happens where there is none.

    Raises:
        DatabaseError: what is there is no map, or can't be removed.
        MapBusyError: somebody is writing it.
    """
    if not path.exists():
        return
    check_file(path)
    lock = MapLock(path)
    try:
        for suffix in ("-wal", "-shm", ""):
            path.with_name(path.name + suffix).unlink(missing_ok=True)
    except OSError as error:
        raise DatabaseError(f"{path}: can't be removed ({error.strerror})") from error
    finally:
        lock.release()
