"""Older schemas of RTAB-Map as the one of 0.20.0: temporary views that stand before the file's tables.

A temporary view lives in the memory of one connection and hides the table of its name, so that everything that reads
asks for the columns of ``tables.py``, whatever version the file has. Like RTAB-Map's own reader this goes by the text
of the version where a column changed its meaning, and beyond that takes a column that is missing for one of NULL.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping

from sqlalchemy import Connection

from slam.database import old_blobs, tables
from slam.database.file_check import Version
from slam.database.old_columns import changed_columns, image_and_depth
from slam.errors import DatabaseError

#: Table of the file -> its columns.
Columns = Mapping[str, frozenset[str]]
#: From this version on the tables are those of ``tables.py``, or have columns more.
_TODAY = (0, 20, 0)


def views(connection: Connection, version: Version) -> tuple[str, ...]:
    """Statements that present a file of this version; none are needed for one of 0.20.0 and later.

    Raises:
        DatabaseError: a table is missing that every version has.
    """
    if version >= _TODAY:
        return ()
    columns = _columns(connection)
    for name in ("Node", "Link", "Word", "Admin"):
        if name not in columns:
            raise DatabaseError(f"it has no table {name}: a map file of RTAB-Map or slamdeck is needed")
    return tuple(_view(name, columns, version) for name in tables.metadata.tables)


def present(connection: Connection, statements: tuple[str, ...]) -> None:
    """Put the views before the tables of a connection that reads."""
    if not statements:
        return
    driver = connection.connection.driver_connection
    assert isinstance(driver, sqlite3.Connection)
    old_blobs.register(driver)
    for statement in statements:
        connection.exec_driver_sql(statement)


def _columns(connection: Connection) -> Columns:
    query = (
        "SELECT m.name, c.name FROM main.sqlite_master AS m, pragma_table_info(m.name, 'main') AS c"
        " WHERE m.type = 'table'"
    )
    found: dict[str, set[str]] = {}
    for table, column in connection.exec_driver_sql(query):
        found.setdefault(table, set()).add(column)
    return {table: frozenset(names) for table, names in found.items()}


def _view(name: str, columns: Columns, version: Version) -> str:
    if name == "Data" and version < (0, 10, 0):
        source, known = image_and_depth(columns)
    else:
        source, known = _one_table(name, columns, version)
    names = [column.name for column in tables.metadata.tables[name].columns]
    chosen = ", ".join(f"{known.get(key, 'NULL')} AS {key}" for key in ("rowid", *names))
    return f"CREATE TEMP VIEW {name} AS SELECT {chosen} FROM {source}"


def _one_table(name: str, columns: Columns, version: Version) -> tuple[str, dict[str, str]]:
    """Where a table is, and what its columns of today are in those that it has."""
    old_name = _old_name(name, version)
    if old_name is None or old_name not in columns:
        return "(SELECT 1) WHERE 0", {}
    known = {key: f"t.{key}" for key in columns[old_name] | {"rowid"}}
    source = f"main.{old_name} AS t"
    if name == "Data" and "user_data" not in known and "user_data" in columns["Node"]:
        source += " LEFT JOIN main.Node AS n ON n.id = t.id"
        known["user_data"] = "deck_text(n.user_data)"
    return source, known | changed_columns(name, known.keys(), version)


def _old_name(name: str, version: Version) -> str | None:
    if name == "Feature" and version < (0, 13, 0):
        return "Map_Node_Word"
    if version < (0, 11, 11):
        return {"Info": "Statistics", "Statistics": None}.get(name, name)
    return name
