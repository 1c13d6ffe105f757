"""Rows of the table Info and the stamps that tell what is in working memory.

RTAB-Map loads the nodes and words whose ``time_enter`` is not before that of the newest Info row, in whole seconds of
UTC. Triggers stamp what is inserted with the time of day; here the stamps are set so that the rule holds whatever the
clock does: a new Info row is at least a second after all that is to stay out, and what is to stay in gets its stamp.
"""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, Table, func, insert, select, update

from slam.database.tables import info, node, word

_FORMAT = "%Y-%m-%d %H:%M:%S"
#: Rows that get their stamp by one call.
_AT_ONCE = 1000


def now_text() -> str:
    """The time of day as SQLite's ``DATETIME('NOW')`` gives it."""
    return datetime.now(UTC).strftime(_FORMAT)


def begin_memory(connection: Connection, parameters: str) -> str:
    """Add the Info row of a session's start, keep what was in working memory there, and return the row's stamp."""
    newest = connection.scalar(select(func.max(info.c.time_enter)))
    stamp = _after(newest)
    _insert_info(connection, stamp, parameters, ram_nodes=0, ram_words=0, last_id=0)
    if newest is not None:
        for table in (node, word):
            connection.execute(update(table).where(table.c.time_enter >= newest).values(time_enter=stamp))
    return stamp


def end_memory(connection: Connection, parameters: str, ram_ids: Iterable[int], ram_word_ids: Iterable[int]) -> None:
    """Add the Info row of a session's end; these nodes and words are what is in working memory, and nothing else."""
    stamps = [connection.scalar(select(func.max(table.c.time_enter))) for table in (node, word, info)]
    stamp = _after(max((s for s in stamps if s), default=None))
    nodes, words = sorted(ram_ids), sorted(ram_word_ids)
    last_id = connection.scalar(select(func.max(node.c.id))) or 0
    _insert_info(connection, stamp, parameters, ram_nodes=len(nodes), ram_words=len(words), last_id=last_id)
    keep_in_memory(connection, stamp, nodes, words)


def read_memory_ids(connection: Connection) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Ascending ids of the nodes and of the words that RTAB-Map would load into working memory."""
    return read_memory_node_ids(connection), _ids_in_memory(connection, word)


def read_memory_node_ids(connection: Connection) -> NDArray[np.int32]:
    """Ascending ids of the nodes alone."""
    return _ids_in_memory(connection, node)


def keep_in_memory(connection: Connection, stamp: str, node_ids: Iterable[int], word_ids: Iterable[int]) -> None:
    """Give nodes and words a stamp."""
    for table, ids in ((node, node_ids), (word, word_ids)):
        rows = iter(ids)
        # A dictionary has tens of thousands of words: in parts, so that their parameters take no memory to speak of.
        while part := [(stamp, int(i)) for i in islice(rows, _AT_ONCE)]:
            connection.exec_driver_sql(f"UPDATE {table.name} SET time_enter = ? WHERE id = ?", part)


def _ids_in_memory(connection: Connection, table: Table) -> NDArray[np.int32]:
    newest = select(func.max(info.c.time_enter)).scalar_subquery()
    query = select(table.c.id).where(table.c.time_enter >= newest).order_by(table.c.id)
    return np.array(connection.scalars(query).all(), dtype=np.int32)


def _after(newest: str | None) -> str:
    if newest is None:
        return now_text()
    following = datetime.strptime(newest, _FORMAT) + timedelta(seconds=1)
    return max(now_text(), following.strftime(_FORMAT))


def _insert_info(
    connection: Connection, stamp: str, parameters: str, *, ram_nodes: int, ram_words: int, last_id: int
) -> None:
    pages, page_size = (
        connection.exec_driver_sql(f"PRAGMA {name}").scalar_one() for name in ("page_count", "page_size")
    )
    row = {
        "STM_size": ram_nodes,
        "last_sign_added": last_id,
        "process_mem_used": 0,
        "database_mem_used": (pages * page_size) & 0x7FFFFFFF if last_id else 0,
        "dictionary_size": ram_words,
        "parameters": parameters,
    }
    done = connection.execute(insert(info).values(row))
    # The trigger has stamped it with the time of day.
    connection.exec_driver_sql("UPDATE Info SET time_enter = ? WHERE rowid = ?", (stamp, done.lastrowid))
