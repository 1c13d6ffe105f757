"""Rows of deck_setting_change: parameters that entries of the journal changed with the map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, insert, inspect, select

from slam.database.deck_tables import setting_change
from slam.database.faults import Faults, each_sound, text_of
from slam.database.records import SettingChange
from slam.errors import DatabaseError, ParameterError
from slam.params import Params


def insert_setting(connection: Connection, number: int, change: SettingChange) -> None:
    """Keep what entry ``number`` of the journal changed."""
    row = {"id": number, "name": change.name, "before": change.before, "after": change.after}
    connection.execute(insert(setting_change), row)


def read_settings(connection: Connection, faults: Faults | None = None) -> Mapping[int, SettingChange]:
    """All changes by the number of their entry; none in files that were written before decisions could change any.

    Rows that make no sense go to ``faults``.
    """
    if not inspect(connection).has_table(setting_change.name):
        return {}
    rows = connection.execute(select(setting_change).order_by(setting_change.c.id))
    return dict(each_sound(setting_change.name, rows, _change, faults))


def _change(row: Any) -> tuple[int, SettingChange]:
    change = SettingChange(text_of(row.name, "name"), text_of(row.before, "before"), text_of(row.after, "after"))
    try:
        for text in (change.before, change.after):
            Params().changed({change.name: text})
    except ParameterError as error:
        raise DatabaseError(str(error)) from error
    return row.id, change
