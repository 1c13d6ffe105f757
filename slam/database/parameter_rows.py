"""Stored parameters: of the newest Info row, and their changes while an engine ran."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, column, func, insert, select

from slam.database.deck_tables import parameter_change, session
from slam.database.deck_values import ParameterChange
from slam.database.faults import Faults, each_sound, number_of, text_of, whole_of
from slam.database.parameter_text import format_parameters, parse_parameters
from slam.database.tables import info, node
from slam.errors import DatabaseError
from slam.params.old_names import todays

_NEWEST_FIRST = (info.c.time_enter.desc(), info.c.STM_size.desc())


def read_parameters(connection: Connection) -> dict[str, str]:
    """Text by today's name of the newest session's parameters; empty when no session was saved."""
    newest = select(info.c.parameters).order_by(*_NEWEST_FIRST).limit(1)
    return todays(parse_parameters(text_of(connection.scalar(newest), "parameters")))


def change_parameters(connection: Connection, changes: Mapping[str, str]) -> None:
    """Change parameters of the newest Info row, and log that they hold after the newest node.

    Raises:
        DatabaseError: there is no such row.
    """
    row = connection.scalar(select(column("rowid")).select_from(info).order_by(*_NEWEST_FIRST).limit(1))
    if row is None:
        raise DatabaseError("the file has no parameters, as no session was ever saved: there are none to change")
    known = read_parameters(connection)
    text = format_parameters({**known, **changes})
    connection.exec_driver_sql("UPDATE Info SET parameters = ? WHERE rowid = ?", (text, row))
    if connection.scalar(select(session.c.map_id).limit(1)) is None:
        # Other programs keep the values of a session nowhere else.
        logged = set(connection.scalars(select(parameter_change.c.name)))
        for name in changes:
            if name in known and name not in logged:
                insert_parameter_change(connection, 0, name, known[name])
    log_parameters(connection, changes)


def log_parameters(connection: Connection, changes: Mapping[str, str]) -> None:
    """Log that parameters have other values after the newest node."""
    node_id = connection.scalar(select(func.max(node.c.id))) or 0
    for name, value in changes.items():
        insert_parameter_change(connection, node_id, name, value)


def insert_parameter_change(connection: Connection, node_id: int, name: str, value: str) -> None:
    """Log that a parameter has another value from a node on."""
    connection.execute(insert(parameter_change).values(time=time.time(), node_id=node_id, name=name, value=value))


def read_parameter_changes(connection: Connection, faults: Faults | None = None) -> list[ParameterChange]:
    """All changes, oldest first. Rows that make no sense go to ``faults``."""
    rows = connection.execute(select(parameter_change).order_by(parameter_change.c.id))
    return list(each_sound(parameter_change.name, rows, _change, faults))


def _change(row: Any) -> ParameterChange:
    return ParameterChange(
        row.id,
        number_of(row.time, "time"),
        whole_of(row.node_id, "node_id"),
        text_of(row.name, "name"),
        text_of(row.value, "value"),
    )
