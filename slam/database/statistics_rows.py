"""Rows of the table Statistics: what each update measured, and who was in working memory."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, insert, select

from slam.database.blobs import pack_row, unpack_matrix
from slam.database.rows import StatisticsTable
from slam.database.statistics_text import pack_statistics, unpack_statistics
from slam.database.tables import statistics


def insert_statistics(
    connection: Connection, node_id: int, stamp: float, values: Mapping[str, float], wm_ids: Sequence[int] | None
) -> None:
    """Add the statistics of a node's update."""
    wm_state = None if wm_ids is None else pack_row(np.array(wm_ids, dtype=np.int32))
    row = {"id": node_id, "stamp": stamp, "data": pack_statistics(values), "wm_state": wm_state}
    connection.execute(insert(statistics).values(row))


def read_statistics(
    connection: Connection, ids: Collection[int] | None, names: Sequence[str] | None, after: int
) -> StatisticsTable:
    """Columns of the updates after node ``after`` (and among ``ids``); all names, or those asked for."""
    wanted = None if ids is None else set(ids)
    rows = [row for row in _rows(connection, after) if wanted is None or row[0] in wanted]
    keys = names if names is not None else sorted({name for *_, values in rows for name in values})
    return StatisticsTable(
        ids=np.array([row[0] for row in rows], dtype=np.int32),
        stamps=np.array([row[1] for row in rows], dtype=np.float64),
        values={key: np.array([values.get(key, np.nan) for *_, values in rows], dtype=np.float64) for key in keys},
    )


def read_wm_states(connection: Connection, after: int) -> dict[int, NDArray[np.int32]]:
    """Ids in short-term and working memory at each update after node ``after``, where they were kept."""
    query = select(statistics.c.id, statistics.c.wm_state).where(statistics.c.id > after)
    states = ((row.id, unpack_matrix(row.wm_state)) for row in connection.execute(query.order_by(statistics.c.id)))
    return {node_id: state.ravel().astype(np.int32) for node_id, state in states if state is not None}


def _rows(connection: Connection, after: int) -> Iterator[tuple[int, float, dict[str, float]]]:
    query = select(statistics.c.id, statistics.c.stamp, statistics.c.data).where(statistics.c.id > after)
    for node_id, stamp, blob in connection.execute(query.order_by(statistics.c.id)):
        yield node_id, stamp or 0.0, unpack_statistics(blob)
