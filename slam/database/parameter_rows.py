"""Stored parameters: of the newest Info row, and their changes while an engine ran."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, insert, select, text, update

from slam.database.deck_tables import parameter_change, session
from slam.database.deck_values import ParameterChange
from slam.database.faults import Faults, each_sound, number_of, text_of, whole_of
from slam.database.parameter_text import format_parameters, parse_parameters
from slam.database.tables import info
from slam.errors import DatabaseError
from slam.params.old_names import todays


def read_parameters(connection: Connection) -> dict[str, str]:
    """Text by today's name of the newest session's parameters; empty when no session was saved."""
    newest = select(info.c.parameters).order_by(info.c.time_enter.desc(), info.c.STM_size.desc()).limit(1)
    return todays(parse_parameters(text_of(connection.scalar(newest), "parameters")))


def update_parameters(connection: Connection, changes: Mapping[str, str]) -> dict[str, str]:
    """Give the newest session other values, under today's names, where whoever opens the map next reads them.

    Returns:
        The values as they were, of those that are in no log yet and are kept with no session.

    Raises:
        DatabaseError: no session was saved, or the text can't carry a value.
    """
    order = (info.c.time_enter.desc(), info.c.STM_size.desc())
    row = connection.execute(
        select(text("rowid"), info.c.parameters).select_from(info).order_by(*order).limit(1)
    ).first()
    if row is None:
        raise DatabaseError(f"{', '.join(changes)} can't be stored: the map has no session that was saved")
    known = todays(parse_parameters(text_of(row.parameters, "parameters")))
    new = format_parameters({**known, **changes})
    connection.execute(update(info).where(text("rowid = :row")).values(parameters=new), {"row": row.rowid})
    if connection.scalar(select(session.c.map_id).limit(1)) is not None:
        return {}
    logged = set(connection.scalars(select(parameter_change.c.name)))
    return {name: known[name] for name in changes if name in known and name not in logged}


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
