"""Rows of the table Statistics: what each update measured, and who was in working memory."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, insert, select

from slam.database.blobs import pack_row, unpack_matrix
from slam.database.faults import Faults, each_sound, node_id_of, number_of
from slam.database.rows import StatisticsTable
from slam.database.statistics_text import pack_statistics, unpack_statistics
from slam.database.tables import statistics
from slam.errors import DatabaseError

#: Names of statistics in a map; RTAB-Map has some 300.
_MOST_NAMES = 4000


def insert_statistics(
    connection: Connection, node_id: int, stamp: float, values: Mapping[str, float], wm_ids: Sequence[int] | None
) -> None:
    """Add the statistics of a node's update."""
    wm_state = None if wm_ids is None else pack_row(np.array(wm_ids, dtype=np.int32))
    row = {"id": node_id, "stamp": stamp, "data": pack_statistics(values), "wm_state": wm_state}
    connection.execute(insert(statistics).values(row))


def read_statistics(
    connection: Connection,
    ids: Collection[int] | None,
    names: Sequence[str] | None,
    after: int,
    faults: Faults | None = None,
) -> StatisticsTable:
    """Columns of the updates after node ``after`` (and among ``ids``); all names, or those asked for.

    Rows that make no sense go to ``faults``.
    """
    query = select(statistics.c.id, statistics.c.stamp, statistics.c.data).where(statistics.c.id > after)
    if ids is not None:
        query = query.where(statistics.c.id.in_(sorted(ids)))
    found_ids, stamps = array("i"), array("d")
    columns: dict[str, array[float]] = {name: array("d") for name in names or ()}
    rows = connection.execute(query.order_by(statistics.c.id))
    for node_id, stamp, values in each_sound("Statistics", rows, _row_maker(columns), faults):
        for name in values if names is None else values.keys() & columns.keys():
            column = columns.setdefault(name, array("d"))
            column.extend([math.nan] * (len(found_ids) - len(column)))
            column.append(values[name])
        found_ids.append(node_id)
        stamps.append(stamp)
    for column in columns.values():
        column.extend([math.nan] * (len(found_ids) - len(column)))
    return StatisticsTable(
        ids=np.array(found_ids, dtype=np.int32),
        stamps=np.array(stamps, dtype=np.float64),
        values={name: np.array(columns[name]) for name in (sorted(columns) if names is None else names)},
    )


def read_wm_states(
    connection: Connection, after: int, most: int | None, faults: Faults | None = None
) -> dict[int, NDArray[np.int32]]:
    """Ids in short-term and working memory at each update after node ``after``, where they were kept.

    Of more than ``most`` such updates the first are read. Rows that make no sense go to ``faults``.
    """
    kept = (statistics.c.id > after) & statistics.c.wm_state.is_not(None)
    query = select(statistics.c.id, statistics.c.wm_state).where(kept).order_by(statistics.c.id).limit(most)
    return dict(state for state in each_sound("Statistics", connection.execute(query), _state, faults) if state)


def _state(row: Any) -> tuple[int, NDArray[np.int32]] | None:
    state = unpack_matrix(row.wm_state)
    return None if state is None else (node_id_of(row.id), state.ravel().astype(np.int32))


def _row_maker(columns: Mapping[str, object]) -> Callable[[Any], tuple[int, float, dict[str, float]]]:
    def make(row: Any) -> tuple[int, float, dict[str, float]]:
        node_id, stamp, blob = row
        values = unpack_statistics(blob)
        if len(columns) + len(values) > _MOST_NAMES and len(columns.keys() | values.keys()) > _MOST_NAMES:
            raise DatabaseError(f"its {len(values)} names make more than the {_MOST_NAMES} that a map may have")
        return node_id_of(node_id), number_of(stamp, "stamp"), values

    return make
