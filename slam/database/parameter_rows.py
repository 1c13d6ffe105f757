"""Stored parameters: of the newest Info row, and their changes while an engine ran."""

from __future__ import annotations

import time

from sqlalchemy import Connection, insert, select

from slam.database.deck_tables import parameter_change
from slam.database.deck_values import ParameterChange
from slam.database.parameter_text import parse_parameters
from slam.database.tables import info
from slam.params.old_names import todays


def read_parameters(connection: Connection) -> dict[str, str]:
    """Text by today's name of the newest session's parameters; empty when no session was saved."""
    newest = select(info.c.parameters).order_by(info.c.time_enter.desc(), info.c.STM_size.desc()).limit(1)
    return todays(parse_parameters(connection.scalar(newest)))


def insert_parameter_change(connection: Connection, node_id: int, name: str, value: str) -> None:
    """Log that a parameter has another value from a node on."""
    connection.execute(insert(parameter_change).values(time=time.time(), node_id=node_id, name=name, value=value))


def read_parameter_changes(connection: Connection) -> list[ParameterChange]:
    """All changes, oldest first."""
    rows = connection.execute(select(parameter_change).order_by(parameter_change.c.id))
    return [ParameterChange(row.id, row.time, row.node_id, row.name, row.value) for row in rows]
