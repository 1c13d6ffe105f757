"""Connections to a map file: one that writes, many that read and change nothing; SQLite's errors become ours."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from sqlalchemy import Connection, Engine, NullPool, create_engine, event
from sqlalchemy.exc import OperationalError, SQLAlchemyError

from slam.database.file_check import has_log, is_write_ahead
from slam.errors import DatabaseError

T = TypeVar("T")

#: Seconds to wait for a lock of SQLite's, which other connections hold for moments.
BUSY_SECONDS = 10.0
_COMING_AND_GOING_SECONDS = 0.5
_HEAL = "open it once for writing, which puts that right"


def reading_engine(path: Path) -> Engine:
    """Engine whose connections never change a byte of the file nor of its folder, and see a writer's last commit."""
    return _engine(lambda: _connect(path, _read_only_mode(path)), "BEGIN")


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """A connection in a transaction: all that is read through it is of one commit."""
    with closing(_persist(lambda: _begun(engine), _COMING_AND_GOING_SECONDS)) as connection:
        yield connection


def _begun(engine: Engine) -> Connection:
    connection = engine.connect()
    try:
        connection.begin()
        # Takes the locks. It fails when a writer comes or goes between the look at the files beside the map and this.
        connection.exec_driver_sql("PRAGMA schema_version").scalar_one()
    except OperationalError:
        connection.close()
        raise
    return connection


def writing_engine(path: Path) -> Engine:
    """Engine whose one connection writes, by a write-ahead log: a killed process leaves whole transactions only."""

    def connect() -> sqlite3.Connection:
        connection = _connect(path, "mode=rw")
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute("PRAGMA synchronous=NORMAL")
        return connection

    return _engine(connect, "BEGIN IMMEDIATE")


def close_plainly(connection: Connection) -> None:
    """Close a writing connection and leave one plain file: the log is merged and gone."""
    try:
        # Not through SQLAlchemy, which would begin a transaction, and this is not possible in one.
        driver = connection.connection.driver_connection
        assert isinstance(driver, sqlite3.Connection)
        _persist(lambda: driver.execute("PRAGMA journal_mode=DELETE").fetchone(), BUSY_SECONDS)
    finally:
        connection.close()


@contextmanager
def refusing(path: Path, doing: str) -> Iterator[None]:
    """Turn what goes wrong into one DatabaseError that says what was being done, to which file, and what would help."""
    try:
        yield
    except DatabaseError as error:
        raise DatabaseError(f"{path}: {doing} failed: {error}") from error
    except (SQLAlchemyError, sqlite3.Error) as error:
        text = str(getattr(error, "orig", None) or error).splitlines()[0]
        raise DatabaseError(f"{path}: {doing} failed: {text}{_advice(text)}") from error
    except OSError as error:
        raise DatabaseError(f"{path}: {doing} failed: {error.strerror or error}") from error


def _persist(attempt: Callable[[], T], seconds: float) -> T:
    """Try again for some seconds what other connections prevent for moments and SQLite itself does not wait for."""
    end = time.monotonic() + seconds
    while True:
        try:
            return attempt()
        except (sqlite3.OperationalError, OperationalError):
            if time.monotonic() > end:
                raise
        time.sleep(0.005)


def _engine(connect: Callable[[], sqlite3.Connection], begin: str) -> Engine:
    engine = create_engine("sqlite://", creator=connect, poolclass=NullPool)

    # Python's sqlite3 would begin transactions only at some statements; here they are begun where the code says so.
    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        connection.exec_driver_sql(begin)

    return engine


def _connect(path: Path, options: str) -> sqlite3.Connection:
    uri = f"file:{quote(str(path.absolute()))}?{options}"
    return sqlite3.connect(uri, uri=True, timeout=BUSY_SECONDS, isolation_level=None, check_same_thread=False)


def _read_only_mode(path: Path) -> str:
    log, index = (path.with_name(path.name + end) for end in ("-wal", "-shm"))
    if is_write_ahead(path) and not (log.exists() and index.exists()):
        if has_log(path):
            raise DatabaseError(f"its last changes are in {log.name}, whose index {index.name} is missing; {_HEAL}")
        # Only the file was copied: it is complete, but opened plainly it would get a log and an index beside it.
        return "mode=ro&immutable=1"
    return "mode=ro&readonly_shm=1"


_ADVICE = (
    ("disk is full", "; nothing of it was written: free some space"),
    ("malformed", "; the file is damaged: copy it again, or repair it with `sqlite3 FILE .recover`"),
    ("not a database", "; a map file of RTAB-Map or slamdeck is needed"),
    ("readonly", "; the file and its folder must be writable"),
    ("rollback journal", f"; {_HEAL}"),
    ("unable to open", "; the file and its folder must be accessible"),
    ("locked", "; another program holds the file: close it first"),
    ("no such", "; the file does not have the tables of its version: it is damaged or not a map"),
)


def _advice(text: str) -> str:
    return next((advice for mark, advice in _ADVICE if mark in text), "")
