"""Connections to a map file: one that writes, many that read and change nothing."""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from sqlalchemy import Connection, Engine, NullPool, create_engine, event
from sqlalchemy.exc import OperationalError

from slam.database.file_check import size_with_log
from slam.database.guard import SMALL_VALUE, check_schema, restrain, restrain_reader
from slam.database.writable import check_writable

T = TypeVar("T")

#: Seconds to wait for a lock of SQLite's, which other connections hold for moments.
BUSY_SECONDS = 10.0
_COMING_AND_GOING_SECONDS = 1.0
#: Held while a writer waits for this process's readers to end; no new ones begin.
_GATE = threading.Lock()
#: Bytes of a write-ahead log's header.
_LOG_HEADER = 32


def reading_engine(path: Path, patience_s: float | None = None) -> Engine:
    """Engine whose connections never change a byte of the file or its log, and see a writer's last commit.

    They wait ``patience_s`` for a lock of another program's, the usual time without.
    """
    return _engine(lambda: _restrained(path, patience_s), "BEGIN")


@contextmanager
def reading(engine: Engine, largest: int = SMALL_VALUE) -> Iterator[Connection]:
    """A connection in a transaction: all that is read through it is of one commit.

    Values of more bytes than ``largest`` are refused.
    """
    with _GATE:
        pass
    with closing(_persist(lambda: _begun(engine), _COMING_AND_GOING_SECONDS)) as connection:
        check_schema(_driver(connection))
        _driver(connection).setlimit(sqlite3.SQLITE_LIMIT_LENGTH, largest)
        yield connection


def _restrained(path: Path, patience_s: float | None) -> sqlite3.Connection:
    driver = _connect(path, _read_only_mode(path), patience_s)
    restrain_reader(driver, size_with_log(path))
    return driver


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


def open_for_writing(path: Path, check: Callable[[Connection], None]) -> Connection:
    """The connection that writes, by a write-ahead log: a killed process leaves whole transactions only.

    ``check`` looks at the file before anything of it is changed, and raises if it is not to be written.
    """
    engine = _engine(lambda: _connect(path, "mode=rw"), "BEGIN IMMEDIATE")
    try:
        return _begin_writing(engine, check)
    except OperationalError as error:
        if "readonly" not in str(error.orig):
            raise
    # A thread of this process that is reading a killed writer's log holds the log's index in a way that bars writers.
    with _GATE:
        return _persist(lambda: _begin_writing(engine, check), _COMING_AND_GOING_SECONDS)


def _begin_writing(engine: Engine, check: Callable[[Connection], None]) -> Connection:
    with ExitStack() as undo:
        connection = engine.connect()
        undo.callback(connection.close)
        driver = _driver(connection)
        restrain(driver)
        check_schema(driver)
        check_writable(driver)
        with connection.begin():
            check(connection)
        _begin_log(_driver(connection))
        undo.pop_all()
    return connection


def close_plainly(connection: Connection) -> None:
    """Close a writing connection and leave one plain file: the log is merged and gone."""
    try:
        # As for the header, so for the file this is journal_mode DELETE; in memory, for the reason below.
        with _GATE:
            _persist(lambda: _driver(connection).execute("PRAGMA journal_mode=MEMORY"), BUSY_SECONDS)
    finally:
        connection.close()


def _begin_log(driver: sqlite3.Connection) -> None:
    # Two bytes of the header change. With a journal on the disk, a process killed just then would leave it there, and
    # nobody could read the map before it is played back.
    if driver.execute("PRAGMA journal_mode").fetchone() != ("wal",):
        driver.execute("PRAGMA journal_mode=MEMORY")
        driver.execute("PRAGMA journal_mode=WAL")
    driver.execute("PRAGMA synchronous=NORMAL")


def _driver(connection: Connection) -> sqlite3.Connection:
    """SQLite's own connection, for what is not possible in the transaction that SQLAlchemy would begin."""
    driver = connection.connection.driver_connection
    assert isinstance(driver, sqlite3.Connection)
    return driver


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


def read_only_uri(path: Path) -> str:
    """Address by which SQLite opens a map file so that nothing is changed or made."""
    return _uri(path, _read_only_mode(path))


def _uri(path: Path, options: str) -> str:
    return f"file:{quote(str(path.absolute()))}?{options}"


def _connect(path: Path, options: str, patience_s: float | None = None) -> sqlite3.Connection:
    timeout = BUSY_SECONDS if patience_s is None else patience_s
    return sqlite3.connect(
        _uri(path, options), uri=True, timeout=timeout, isolation_level=None, check_same_thread=False
    )


def _read_only_mode(path: Path) -> str:
    """Options that let SQLite read without making or changing a file, whatever lies beside the map."""
    log, index = (path.with_name(path.name + end) for end in ("-wal", "-shm"))
    logged = log.stat().st_size if log.exists() else 0
    # The log's index is missing (only the two others were copied, or a writer was killed as it closed): SQLite makes a
    # new one, the only case in which a file appears; without it the log can't be read.
    if logged > _LOG_HEADER and not index.exists():
        return "mode=ro"
    # Without a log (only the file was copied) or with one that holds nothing (its writer was killed when it had just
    # begun one), a file in WAL mode is complete. Opened plainly the first would get a log, the second would be refused.
    if logged == _LOG_HEADER or (not (log.exists() and index.exists()) and _is_write_ahead(path)):
        return "mode=ro&immutable=1"
    return "mode=ro&readonly_shm=1"


def _is_write_ahead(path: Path) -> bool:
    # Only asked where no log lies beside the file, so that no writer of this process is at work: closing the file frees
    # all locks that the process has on it.
    with path.open("rb") as file:
        return file.read(20)[18:] == b"\2\2"
