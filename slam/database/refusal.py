"""One clear error for whatever goes wrong with a map file."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy.exc import SQLAlchemyError

from slam.errors import DamagedRowError, DatabaseError, MapBusyError

_ADVICE = (
    ("disk is full", "; all that was in the map is kept: free some space"),
    ("malformed", "; the file is damaged or cut off: copy it again, or save what is left with `slamdeck recover`"),
    ("not a database", "; a map file of RTAB-Map or slamdeck is needed"),
    ("readonly", "; the file and its folder must be writable"),
    ("unable to open", "; the file and its folder must be accessible"),
    ("locked", "; another program holds the file: close it first"),
    ("interrupted", "; the file asks for more work than one of its size can hold: it is damaged"),
    ("too big", "; a value is larger than any of a map: the file is damaged"),
    ("no such", "; the file does not have the tables of its version: it is damaged or not a map"),
)


@contextmanager
def refusing(path: Path, doing: str) -> Iterator[None]:
    """Turn what goes wrong into one DatabaseError that says what was being done, to which file, and what would help."""
    try:
        yield
    except DamagedRowError as error:
        raise DamagedRowError(error.table, error.row, error.reason, f"{path}: {doing} failed: ") from error
    except DatabaseError as error:
        raise type(error)(f"{path}: {doing} failed: {error}") from error
    except (SQLAlchemyError, sqlite3.Error) as error:
        text = str(getattr(error, "orig", None) or error).splitlines()[0]
        kind = MapBusyError if "locked" in text else DatabaseError
        raise kind(f"{path}: {doing} failed: {text}{_advice(text)}") from error
    except UnicodeDecodeError as error:
        # Text of the file, or SQLite's own message that quotes it.
        raise DatabaseError(f"{path}: {doing} failed: it holds text that is none; the file is damaged") from error
    except OSError as error:
        raise DatabaseError(f"{path}: {doing} failed: {error.strerror or error}") from error


def _advice(text: str) -> str:
    return next((advice for mark, advice in _ADVICE if mark in text), "")
