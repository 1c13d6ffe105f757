"""The statistics of an update as RTAB-Map stores them: ``Group/Name/Unit:value;...``, sorted, compressed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from slam.database.blobs import MAX_STATISTICS_BYTES, pack_row, unpack_matrix
from slam.errors import DatabaseError


def format_statistics(values: Mapping[str, float]) -> str:
    """Text of the statistics; values have six significant digits, as RTAB-Map prints them."""
    for name in values:
        if not name or any(mark in name for mark in ":;\0"):
            raise DatabaseError(f"statistic {name!r} can't be stored: a name must not be empty nor hold ':' or ';'")
    return ";".join(f"{name}:{values[name]:g}" for name in sorted(values))


def parse_statistics(text: str) -> dict[str, float]:
    """Values by name; as in RTAB-Map, a pair that is not ``name:number`` is left out."""
    values: dict[str, float] = {}
    for pair in text.split(";"):
        parts = pair.split(":")
        if len(parts) == 2 and parts[0]:
            try:
                values[parts[0]] = float(parts[1])
            except ValueError:
                continue
    return values


def pack_statistics(values: Mapping[str, float]) -> bytes | None:
    """Blob of the statistics; None when there are none."""
    if not values:
        return None
    raw = format_statistics(values).encode() + b"\0"
    return pack_row(np.frombuffer(raw, dtype=np.int8))


def unpack_statistics(blob: bytes | None) -> dict[str, float]:
    """Values by name of a blob; empty for NULL."""
    matrix = unpack_matrix(blob, MAX_STATISTICS_BYTES)
    if matrix is None:
        return {}
    return parse_statistics(matrix.tobytes().split(b"\0", 1)[0].decode(errors="replace"))
