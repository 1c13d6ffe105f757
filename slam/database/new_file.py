"""Making an empty map file, whole or not at all."""

from __future__ import annotations

import sqlite3
from contextlib import ExitStack, closing
from pathlib import Path

from sqlalchemy import NullPool, create_engine

from slam.database.refusal import refusing
from slam.database.schema import create_schema
from slam.errors import DatabaseError


def create_file(path: Path) -> None:
    """Create a map file without nodes; it appears under its name only when it is complete.

    Raises:
        DatabaseError: the file exists, or can't be made there.
    """
    if path.exists():
        raise DatabaseError(f"{path} exists already: choose another name, or open it to go on with it")
    unfinished = path.with_name(path.name + ".new")
    with refusing(path, "creating the map"):
        # A log left over from a deleted file of this name would be taken for the new file's own.
        _remove(unfinished, *(path.with_name(path.name + end) for end in ("-wal", "-shm", "-journal")))
        with ExitStack() as undo:
            undo.callback(_remove, unfinished)
            _fill(unfinished)
            unfinished.rename(path)
            undo.pop_all()


def _remove(*paths: Path) -> None:
    for path in paths:
        path.unlink(missing_ok=True)


def _fill(path: Path) -> None:
    engine = create_engine("sqlite://", creator=lambda: sqlite3.connect(path), poolclass=NullPool)
    with closing(engine.connect()) as connection:
        # Until it has its name nobody needs the file: without a journal nothing but the file itself can be left over.
        connection.exec_driver_sql("PRAGMA journal_mode=OFF")
        create_schema(connection)
        connection.commit()
