"""How sure a camera was of the depth of each pixel: a column that RTAB-Map's files have since 0.22."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, text

from slam.database.blobs import NOTHING, unpack_matrix
from slam.errors import DatabaseError

_COLUMN = "depth_confidence"


def has_confidence(connection: Connection, node_id: int) -> bool:
    """Whether it is stored of a node."""
    return bool(_of(connection, f"length({_COLUMN}) > {NOTHING}", node_id))


def read_confidence(connection: Connection, node_id: int) -> NDArray[np.uint8] | None:
    """(H, W) 0 to 100 of each pixel of the node's depth image; None where it is not stored."""
    matrix = unpack_matrix(_of(connection, _COLUMN, node_id))
    if matrix is None:
        return None
    if matrix.ndim != 2 or matrix.dtype != np.uint8:
        raise DatabaseError(f"confidence is {matrix.dtype} of shape {matrix.shape}, not uint8 of (rows, columns)")
    return matrix.astype(np.uint8)


def _of(connection: Connection, expression: str, node_id: int) -> Any:
    columns = {row[1] for row in connection.exec_driver_sql("PRAGMA table_info(Data)")}
    if _COLUMN not in columns:
        return None
    return connection.scalar(text(f"SELECT {expression} FROM Data WHERE id = :id"), {"id": node_id})
