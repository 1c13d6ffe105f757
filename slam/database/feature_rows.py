"""Rows of the table Feature: the key points of a node."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, select, text

from slam.database.insertion import insert_rows
from slam.database.tables import feature
from slam.errors import DatabaseError
from slam.types import Descriptors, Features, Node

_COLUMNS = tuple(feature.c.keys())
_READ = f"SELECT {', '.join(_COLUMNS[1:])} FROM Feature WHERE node_id = ? ORDER BY rowid"
_NO_ANGLE = -1.0


def insert_features(connection: Connection, node: Node) -> None:
    """Add the key points of a node, in their order.

    The table refuses NULL, which SQLite makes of NaN: an angle that is not a number is stored as -1 (none), a response
    as 0; points that are not finite become NULL, as RTAB-Map has it. Sizes are cut to whole pixels, as there.

    Raises:
        DatabaseError: a pixel is not finite, or there is not one word id for each key point.
    """
    items = node.features
    if len(node.word_ids) != len(items):
        raise DatabaseError(
            f"node {node.id} has {len(items)} key points and {len(node.word_ids)} word ids: one each is needed"
        )
    if not np.all(np.isfinite(items.pixels)):
        raise DatabaseError(f"node {node.id} has a key point whose pixel is not a number")
    insert_rows(connection, feature, _COLUMNS, _rows(node.id, items, node.word_ids))


def _rows(node_id: int, items: Features, word_ids: NDArray[np.int32]) -> list[tuple[Any, ...]]:
    known = np.all(np.isfinite(items.points_base), axis=1, keepdims=True)
    size = items.descriptors.shape[1] if items.descriptors.ndim == 2 else 0
    raw = np.ascontiguousarray(items.descriptors).tobytes()
    length = size * items.descriptors.itemsize
    count = len(items)
    return list(
        zip(
            [node_id] * count,
            word_ids.tolist(),
            *items.pixels.T.tolist(),
            np.trunc(np.nan_to_num(items.sizes)).astype(int).tolist(),
            np.where(np.isfinite(items.angles), items.angles, _NO_ANGLE).tolist(),
            np.where(np.isfinite(items.responses), items.responses, 0.0).tolist(),
            items.octaves.tolist(),
            *np.where(known, items.points_base, np.nan).T.tolist(),
            [size] * count,
            [raw[i : i + length] for i in range(0, count * length, length)] if size else [None] * count,
            strict=True,
        )
    )


def rename_words(connection: Connection, renamed: Mapping[int, Mapping[int, int]]) -> None:
    """Give key points of older nodes (id -> old word -> new one) the words that they became, as RTAB-Map does."""
    for node_id, words in renamed.items():
        # By row number: a search for each word would read all key points of the node each time, and could rename twice.
        query = select(text("rowid"), feature.c.word_id).where(feature.c.node_id == node_id)
        rows = [(words[word], row) for row, word in connection.execute(query).all() if word in words]
        if rows:
            connection.exec_driver_sql("UPDATE Feature SET word_id = ? WHERE rowid = ?", rows)


def read_features(connection: Connection, node_id: int) -> tuple[Features, NDArray[np.int32]]:
    """Key points of a node and their word ids, in the order they were written; empty when it has none."""
    # SQLite's own rows: a thousand values of each node that comes back in an update need no second look.
    rows = connection.exec_driver_sql(_READ, (node_id,)).all()
    words, x, y, sizes, angles, responses, octaves, px, py, pz, widths, raw = (
        zip(*rows, strict=True) if rows else ((),) * 12
    )
    features = Features(
        pixels=np.column_stack([_float32(x), _float32(y)]),
        sizes=_float32(sizes),
        angles=_float32(angles),
        responses=_float32(responses),
        octaves=np.array(octaves, dtype=np.int64).astype(np.int32),
        descriptors=read_descriptors(node_id, widths, raw),
        points_base=np.column_stack([_float32(px), _float32(py), _float32(pz)]),
    )
    for name in ("pixels", "sizes", "angles", "responses"):
        if not np.isfinite(getattr(features, name)).all():
            raise DatabaseError(f"one of its key points has {name} that are not finite: the file is damaged")
    return features, np.array(words, dtype=np.int32)


def read_descriptors(owner: int, widths: tuple[int | None, ...], raw: tuple[bytes | None, ...]) -> Descriptors:
    """Descriptors (N, B): uint8 where the size that is stored counts bytes, float32 where it counts a fourth of them.

    Raises:
        DatabaseError: they are not all of one length.
    """
    lengths = {len(blob or b"") for blob in raw}
    if len(lengths) > 1:
        raise DatabaseError(
            f"descriptors of node or word {owner} have different lengths {sorted(lengths)}: the file is damaged"
        )
    length = lengths.pop() if lengths else 0
    if length and {length // (width or 1) for width in widths} - {1, 4}:
        raise DatabaseError(
            f"descriptors of node or word {owner} have {length} bytes, which their size does not explain"
        )
    joined = b"".join(blob or b"" for blob in raw)
    if length and length == 4 * (widths[0] or 1):
        return np.frombuffer(joined, dtype="<f4").astype(np.float32).reshape(len(raw), length // 4)
    return np.frombuffer(joined, dtype=np.uint8).reshape(len(raw), length)


def _float32(values: tuple[float | None, ...]) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):
        return np.array(values, dtype=np.float64).astype(np.float32)
