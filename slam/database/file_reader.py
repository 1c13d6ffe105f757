"""Opening a map file for reading, again for each call."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection

from slam.database.admin_rows import read_version
from slam.database.connection import reading, reading_engine
from slam.database.file_check import check_file, check_version
from slam.database.guard import SMALL_VALUE
from slam.database.old_schema import present, views
from slam.database.refusal import refusing
from slam.database.schema import has_deck_tables
from slam.errors import DatabaseError


class FileReader:
    """A map file of a known version, opened and closed by each call, so that calls may come from any thread.

    Attributes:
        path: the file.
        version: of its schema; what is read is presented as that of 0.20.0.
    """

    def __init__(self, path: Path, patience_s: float | None = None) -> None:
        """Open a file; where another program holds it, wait so long at each call, or as long as is usual."""
        check_file(path)
        self.path = path
        self._engine = reading_engine(path, patience_s)
        self._views: tuple[str, ...] = ()
        with self._reading("opening") as connection:
            self.version = check_version(read_version(connection))
            self._views = views(connection, self.version)

    @contextmanager
    def _reading(self, doing: str, largest: int = SMALL_VALUE) -> Iterator[Connection]:
        """A connection for one call; values of more bytes than ``largest`` are refused."""
        check_file(self.path)
        with refusing(self.path, doing), _making_sense(), reading(self._engine, largest) as connection:
            present(connection, self._views)
            yield connection

    @contextmanager
    def _deck(self, doing: str, largest: int = SMALL_VALUE) -> Iterator[Connection | None]:
        with self._reading(doing, largest) as connection:
            yield connection if has_deck_tables(connection) else None


@contextmanager
def _making_sense() -> Iterator[None]:
    """SQLite keeps anything in any column: what is not of the column's kind can't be understood."""
    try:
        yield
    except (ValueError, TypeError, OverflowError) as error:
        text = str(error).partition("\n")[0]
        raise DatabaseError(f"a value is not of the kind that its column has: {text}; the file is damaged") from error
