"""Rows of deck_session: when a session began and ended, with what seed, source and parameters."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from sqlalchemy import Connection, func, insert, select, update

from slam.database.blobs import unpack_matrix
from slam.database.deck_tables import session
from slam.database.faults import Faults, each_sound, number_of, text_of, whole_of
from slam.database.parameter_text import parse_parameters
from slam.database.rows import SessionRow
from slam.database.tables import feature, node, statistics
from slam.database.time_enter import end_memory
from slam.types import WEIGHT_INVALID

_EMPTY = SessionRow(
    map_id=0, nodes=0, started=None, closed=None, clean=True, seed=None, source="", parameters=MappingProxyType({})
)


def insert_session(connection: Connection, parameters: str, seed: int, source: str) -> int:
    """Begin a session after the last one; its number."""
    last = [connection.scalar(select(func.max(column))) for column in (node.c.map_id, session.c.map_id)]
    map_id = max((number for number in last if number is not None), default=-1) + 1
    values = {"map_id": map_id, "started": time.time(), "seed": seed, "source": source, "parameters": parameters}
    connection.execute(insert(session).values(values))
    return map_id


def end_sessions(connection: Connection, *, clean: bool) -> None:
    """Mark every session that still runs as ended."""
    connection.execute(update(session).where(session.c.closed.is_(None)).values(closed=time.time(), clean=clean))


def heal_sessions(connection: Connection) -> None:
    """End, as not clean, sessions whose process was killed; working memory is what it was at the last update."""
    parameters = connection.scalar(
        select(session.c.parameters).where(session.c.closed.is_(None)).order_by(session.c.map_id.desc()).limit(1)
    )
    if parameters is not None:
        ram_ids = _last_memory(connection)
        end_memory(connection, parameters, ram_ids, _words_of(connection, ram_ids))
        end_sessions(connection, clean=False)


def read_sessions(connection: Connection, *, deck: bool, faults: Faults | None = None) -> list[SessionRow]:
    """All sessions by number; for files of RTAB-Map (``deck`` false) only their number and nodes are known.

    Rows that make no sense go to ``faults``.
    """
    whole = func.typeof(node.c.map_id) == "integer"
    counted = select(node.c.map_id, func.count().filter(node.c.weight > WEIGHT_INVALID)).where(whole)
    nodes: dict[int, int] = dict(connection.execute(counted.group_by(node.c.map_id)).all())
    rows = connection.execute(select(session)) if deck else ()
    stored = {row.map_id: row for row in each_sound(session.name, rows, _session_row, faults)}
    return [
        replace(stored.get(map_id, _EMPTY), map_id=map_id, nodes=nodes.get(map_id, 0))
        for map_id in sorted(nodes.keys() | stored.keys())
    ]


def _session_row(row: Any) -> SessionRow:
    return SessionRow(
        map_id=whole_of(row.map_id, "map_id"),
        nodes=0,
        started=None if row.started is None else number_of(row.started, "started"),
        closed=None if row.closed is None else number_of(row.closed, "closed"),
        clean=bool(row.clean),
        seed=None if row.seed is None else whole_of(row.seed, "seed"),
        source=text_of(row.source, "source"),
        parameters=parse_parameters(text_of(row.parameters, "parameters")),
    )


def _last_memory(connection: Connection) -> set[int]:
    query = select(statistics.c.id, statistics.c.wm_state).where(statistics.c.wm_state.is_not(None))
    last = connection.execute(query.order_by(statistics.c.id.desc()).limit(1)).first()
    state = None if last is None else unpack_matrix(last.wm_state)
    newer = select(node.c.id).where(node.c.weight > WEIGHT_INVALID)
    if last is None or state is None:
        return set(connection.scalars(newer))
    return {int(i) for i in state.ravel()} | set(connection.scalars(newer.where(node.c.id > last.id)))


def _words_of(connection: Connection, node_ids: Iterable[int]) -> set[int]:
    words: set[int] = set()
    for node_id in node_ids:
        query = select(feature.c.word_id).where((feature.c.node_id == node_id) & (feature.c.word_id > 0))
        words.update(connection.scalars(query))
    return words
