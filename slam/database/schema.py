"""Creating the tables of a map file."""

from __future__ import annotations

from sqlalchemy import Connection, insert, inspect

from slam.database import deck_tables, tables
from slam.database.file_check import WRITTEN_VERSION


def create_schema(connection: Connection) -> None:
    """All tables, indexes and triggers of RTAB-Map 0.20.0 with its one Admin row, and slamdeck's own tables."""
    tables.metadata.create_all(connection)
    for trigger in tables.TRIGGERS:
        connection.exec_driver_sql(trigger)
    connection.execute(insert(tables.admin).values(version=WRITTEN_VERSION))
    add_deck_tables(connection)


def add_deck_tables(connection: Connection) -> None:
    """Slamdeck's own tables, where a file that RTAB-Map wrote lacks them."""
    deck_tables.metadata.create_all(connection)


def has_deck_tables(connection: Connection) -> bool:
    """Whether slamdeck has written to this file."""
    return inspect(connection).has_table(deck_tables.session.name)
