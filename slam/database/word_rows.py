"""Rows of the table Word: the visual dictionary."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sqlalchemy import Connection, func, select

from slam.database.feature_rows import read_descriptors
from slam.database.insertion import insert_rows
from slam.database.records import WordRows
from slam.database.tables import word

_AT_ONCE = 10_000
_READ = "SELECT id, descriptor_size, descriptor FROM Word {} ORDER BY id"


def insert_words(connection: Connection, words: WordRows) -> None:
    """Add words to the dictionary."""
    descriptors = np.ascontiguousarray(words.descriptors)
    rows = [(word_id, len(row), row.tobytes()) for word_id, row in zip(words.ids.tolist(), descriptors, strict=True)]
    insert_rows(connection, word, ("id", "descriptor_size", "descriptor"), rows)


def read_word_ids(connection: Connection) -> set[int]:
    """All ids of the dictionary."""
    return set(connection.scalars(select(word.c.id)))


def read_last_word_id(connection: Connection) -> int:
    """The largest id of the dictionary, 0 when it is empty."""
    return connection.scalar(select(func.max(word.c.id))) or 0


def read_words(connection: Connection, only: Sequence[int] | None = None) -> WordRows:
    """The whole dictionary, or those of its words that are asked for; ascending by id."""
    parts = [_READ.format("")] if only is None else [_READ.format(_among(part)) for part in _parts(sorted(only))]
    rows = [row for part in parts for row in connection.exec_driver_sql(part).all()]
    ids, widths, raw = zip(*rows, strict=True) if rows else ((), (), ())
    return WordRows(np.array(ids, dtype=np.int32), read_descriptors(0, widths, raw))


def _among(ids: Sequence[int]) -> str:
    # As text: with a value bound to each of a thousand ids SQLAlchemy takes longer than SQLite does to find them.
    return f"WHERE id IN ({','.join(str(int(word_id)) for word_id in ids)})"


def _parts(ids: Sequence[int]) -> list[Sequence[int]]:
    return [ids[at : at + _AT_ONCE] for at in range(0, max(1, len(ids)), _AT_ONCE)]
