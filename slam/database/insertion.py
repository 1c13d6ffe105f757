"""Inserting many rows at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Connection, Table


def insert_rows(connection: Connection, table: Table, columns: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> None:
    """Insert tuples in the order of ``columns``: several times faster than a dictionary for each of 1000 key points."""
    if rows:
        unknown = set(columns) - set(table.c.keys())
        assert not unknown, unknown
        marks = ",".join("?" * len(columns))
        connection.exec_driver_sql(f"INSERT INTO {table.name} ({','.join(columns)}) VALUES ({marks})", list(rows))
