"""What a map file may not do to its reader.

A map may come from anybody. What is read is therefore bounded by what a file of its size can hold, nothing of its
schema is carried out, and only plain tables are taken for RTAB-Map's.
"""

from __future__ import annotations

import re
import sqlite3
import sys
from functools import lru_cache
from itertools import count

from slam.database import deck_tables, tables
from slam.errors import DatabaseError

#: Bytes of the largest value that lists of rows may hold, and of the largest image, cloud or grid.
SMALL_VALUE, LARGE_VALUE = 1 << 20, 1 << 28
#: Steps of SQLite's machine that any call may take, that each byte of the file adds, and that none may exceed.
_STEPS, _STEPS_PER_BYTE, _MOST_STEPS = 2_000_000, 4, 1_000_000_000
_LOOK_EVERY = 100_000
_ALLOWED = {
    sqlite3.SQLITE_SELECT,
    sqlite3.SQLITE_READ,
    sqlite3.SQLITE_FUNCTION,
    sqlite3.SQLITE_TRANSACTION,
    sqlite3.SQLITE_CREATE_TEMP_VIEW,
}
_PRAGMAS = {"schema_version", "read_uncommitted", "table_info", "table_xinfo", "index_list", "query_only"}
_OF_OLD_VERSIONS = ("Map_Node_Word", "Image", "Depth")
_KNOWN = {name.lower() for name in (*tables.metadata.tables, *deck_tables.metadata.tables, *_OF_OLD_VERSIONS)}
_KINDS = {"table": "TABLE", "view": "VIEW", "index": "(?:UNIQUE )?INDEX", "trigger": "TRIGGER"}
_NAME = r"""(?:"((?:[^"]|"")*)"|'((?:[^']|'')*)'|`((?:[^`]|``)*)`|\[([^\]]*)\]|([^\s("'`\[.]+))"""


def restrain(driver: sqlite3.Connection) -> None:
    """Functions that the file's schema names are those of plain SQL only, and values have limits."""
    driver.execute("PRAGMA trusted_schema = OFF")
    driver.execute("PRAGMA cell_size_check = ON")
    if sys.version_info >= (3, 12):
        driver.setconfig(sqlite3.SQLITE_DBCONFIG_DEFENSIVE, True)
    driver.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGE_VALUE)
    driver.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)
    driver.setlimit(sqlite3.SQLITE_LIMIT_TRIGGER_DEPTH, 8)


def restrain_reader(driver: sqlite3.Connection, file_bytes: int) -> None:
    """The same for one that only reads: it may do nothing else, and not more than the file has room for.

    Text that is no UTF-8 is read with marks in place of what is none.
    """
    restrain(driver)
    steps = min(_STEPS + _STEPS_PER_BYTE * file_bytes, _MOST_STEPS)
    looks = count(1)
    driver.set_progress_handler(lambda: next(looks) * _LOOK_EVERY > steps, _LOOK_EVERY)
    driver.set_authorizer(_authorize)
    driver.text_factory = lambda raw: raw.decode(errors="replace")


def _authorize(action: int, name: str | None, column: str | None, database: str | None, inside: str | None) -> int:
    del column, inside
    # What is temporary is the connection's own, and lives in its memory.
    if action in _ALLOWED or database == "temp":
        return sqlite3.SQLITE_OK
    if action == sqlite3.SQLITE_PRAGMA:
        return sqlite3.SQLITE_OK if name in _PRAGMAS else sqlite3.SQLITE_DENY
    # This is asked when a pragma is used as a table, and changes nothing.
    declares = action == sqlite3.SQLITE_UPDATE and name == "sqlite_master"
    return sqlite3.SQLITE_OK if declares else sqlite3.SQLITE_DENY


def check_schema(connection: sqlite3.Connection) -> None:
    """Refuse a schema in which something else than a plain table goes by a name of RTAB-Map's or slamdeck's.

    Its text is looked at before any statement names a table: views are unfolded as a statement is prepared.

    Raises:
        DatabaseError: a view or a table that computes is in place of one of a map, or the text is not SQLite's own.
    """
    found = connection.execute("SELECT type, name, sql FROM main.sqlite_master WHERE sql IS NOT NULL").fetchall()
    for name in _perhaps_computed(tuple(found)):
        hidden = connection.execute("SELECT name FROM pragma_table_xinfo(?, 'main') WHERE hidden <> 0", (name,))
        for (column,) in hidden:
            raise DatabaseError(f"column {column} of its table {name} is computed, not stored: this is no map")


@lru_cache(maxsize=64)
def _perhaps_computed(found: tuple[tuple[object, object, object], ...]) -> tuple[str, ...]:
    """Names of a map's tables whose text may have columns that are computed; DatabaseError as in ``check_schema``."""
    for entry in found:
        _check_entry(*entry)
    tables = ((str(name), str(sql)) for kind, name, sql in found if kind == "table")
    return tuple(name for name, sql in tables if name.lower() in _KNOWN and re.search(r"\bAS\b", sql, re.IGNORECASE))


def _check_entry(kind: object, name: object, sql: object) -> None:
    shown = f"its schema has a {str(kind)[:20]} {str(name)[:60]!r}"
    if not (isinstance(kind, str) and isinstance(name, str) and isinstance(sql, str)):
        raise DatabaseError(f"{shown} whose text is none: the file is damaged")
    if re.match(r"CREATE VIRTUAL ", sql, re.IGNORECASE):
        raise DatabaseError(f"{shown} that is virtual: a map has plain tables only")
    said = re.match(rf"CREATE {_KINDS.get(kind, '(?!)')}\s+{_NAME}", sql, re.IGNORECASE)
    if said is None or _bare(said).lower() != name.lower():
        raise DatabaseError(f"{shown} whose text says something else: the file is damaged or was tampered with")
    if kind == "view" and name.lower() in _KNOWN:
        raise DatabaseError(f"its {name} is a view, and a table is needed: this is no map")


def _bare(said: re.Match[str]) -> str:
    for mark, part in zip("\"'`] ", said.groups(), strict=True):
        if part is not None:
            return part.replace(2 * mark, mark)
    return ""
