"""Matrices, transforms and information as RTAB-Map's blobs.

A matrix blob ("z") is a zlib stream of the rows followed by three int32: rows, columns and OpenCV's type code, which
is the depth (u8 s8 u16 s16 s32 f32 f64) plus 8 times the channels less one. Everything is little-endian.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam.errors import DatabaseError
from slam.geometry import Pose

_DTYPES = tuple(np.dtype(code) for code in ("u1", "i1", "<u2", "<i2", "<i4", "<f4", "<f8"))
_TRAILER = 12
#: Bytes from which a matrix is taken for a damaged one: RTAB-Map's largest, an assembled cloud, stays far below.
MAX_BYTES = 1 << 29
#: Blobs of that many bytes or fewer count as absent: old writers stored four zero bytes for nothing.
NOTHING = 4


def pack_matrix(matrix: NDArray[np.generic], *, level: int = -1) -> bytes | None:
    """Blob of a (rows, columns) or (rows, columns, channels) matrix; None (SQL NULL) when it is empty."""
    if matrix.size == 0:
        return None
    rows, columns, *channels = matrix.shape
    dtype = matrix.dtype.newbyteorder("<")
    kind = _DTYPES.index(dtype) + 8 * ((channels[0] if channels else 1) - 1)
    trailer = np.array([rows, columns, kind], dtype="<i4").tobytes()
    return zlib.compress(np.ascontiguousarray(matrix, dtype=dtype).tobytes(), level) + trailer


def unpack_matrix(blob: bytes | None) -> NDArray[np.generic] | None:
    """Matrix (rows, columns) or (rows, columns, channels) of a blob; None for NULL and for the old four-byte nothing.

    Raises:
        DatabaseError: the blob is damaged, or claims a size that no map has.
    """
    if blob is None or len(blob) <= NOTHING:
        return None
    if len(blob) <= _TRAILER:
        raise DatabaseError(f"matrix blob of {len(blob)} bytes is too short: a stream and three integers were expected")
    rows, columns, kind = (int(v) for v in np.frombuffer(blob[-_TRAILER:], dtype="<i4"))
    depth, channels = kind % 8, kind // 8 + 1
    if rows <= 0 or columns <= 0 or kind < 0 or depth >= len(_DTYPES):
        raise DatabaseError(f"matrix blob says {rows} rows, {columns} columns, type {kind}, which no matrix has")
    dtype = _DTYPES[depth]
    size = rows * columns * channels * dtype.itemsize
    if size > MAX_BYTES:
        raise DatabaseError(
            f"matrix blob claims {size} bytes, more than the {MAX_BYTES} that any map needs: it is damaged"
        )
    values = np.frombuffer(_inflate(blob, size), dtype=dtype)
    return values.reshape((rows, columns, channels) if channels > 1 else (rows, columns))


def _inflate(blob: bytes, size: int) -> bytes:
    inflater = zlib.decompressobj()
    try:
        raw = inflater.decompress(blob[:-_TRAILER], size + 1)
    except zlib.error as error:
        raise DatabaseError(f"matrix blob is damaged: {error}") from error
    if len(raw) != size:
        more = " or more" if len(raw) > size else ""
        raise DatabaseError(f"matrix blob holds {len(raw)} bytes{more} where its size says {size}: it is damaged")
    return raw


def pack_row(values: NDArray[np.generic]) -> bytes | None:
    """Blob of a vector (N,), or of N points (N, channels), as one row; None when it is empty."""
    return pack_matrix(values[np.newaxis])


def pack_transform(T_a_b: Pose | None) -> bytes:
    """48 bytes: the upper three rows as float32; all zero (RTAB-Map's null) for None."""
    if T_a_b is None:
        return bytes(48)
    return np.ascontiguousarray(T_a_b[:3], dtype="<f4").tobytes()


def unpack_transform(blob: bytes | None) -> Pose | None:
    """(4, 4) pose; None for NULL, for the null transform, and for one with a NaN."""
    if blob is None or len(blob) != 48:
        return None
    (T_a_b,) = stack_rows(np.frombuffer(blob, dtype="<f4"))
    return None if np.isnan(T_a_b[0, 0]) else T_a_b


def pack_pose(T_a_b: Pose | None) -> bytes | None:
    """96 bytes, the upper three rows as float64, for slamdeck's own tables."""
    return None if T_a_b is None else np.ascontiguousarray(T_a_b[:3], dtype="<f8").tobytes()


def unpack_pose(blob: bytes | None) -> Pose | None:
    """(4, 4) pose of 96 bytes; None for NULL."""
    return unpack_poses([blob])[0]


def unpack_poses(blobs: Sequence[bytes | None]) -> list[Pose | None]:
    """Poses of many blobs of 96 bytes; None for NULL."""
    null = bytes(96)
    raw = b"".join(blob if blob is not None and len(blob) == 96 else null for blob in blobs)
    stack = stack_rows(np.frombuffer(raw, dtype="<f8"))
    known = np.isfinite(stack[:, 0, 0])
    return [T_a_b if ok else None for T_a_b, ok in zip(stack, known.tolist(), strict=True)]


def stack_transforms(blobs: Sequence[bytes | None]) -> NDArray[np.float64]:
    """Poses (N, 4, 4) of transform blobs; NaN where ``unpack_transform`` gives None."""
    null = bytes(48)
    raw = b"".join(blob if blob is not None and len(blob) == 48 else null for blob in blobs)
    return stack_rows(np.frombuffer(raw, dtype="<f4"))


def stack_rows(numbers: NDArray[np.floating]) -> NDArray[np.float64]:
    """Poses (N, 4, 4) of 12 N numbers, three rows each; NaN for the null transform and for one that is not finite."""
    rows = numbers.reshape(-1, 3, 4)
    stack = np.zeros((len(rows), 4, 4))
    stack[:, :3] = rows
    stack[:, 3, 3] = 1.0
    stack[~(np.any(rows, axis=(1, 2)) & np.all(np.isfinite(rows), axis=(1, 2)))] = np.nan
    return stack


def pack_transforms(T_a_b: Sequence[Pose]) -> NDArray[np.float32]:
    """One row (1, 12 N) of the transforms back to back, as in ``Admin.opt_poses``."""
    return np.array(T_a_b, dtype=np.float32).reshape(-1, 4, 4)[:, :3].reshape(1, -1)


def pack_information(information: NDArray[np.float64]) -> bytes:
    """288 bytes of a (6, 6) information matrix.

    Raises:
        DatabaseError: a diagonal entry is not finite or not positive: RTAB-Map refuses to load such a file.
    """
    if information.shape != (6, 6) or not np.all(np.isfinite(information)) or np.any(np.diag(information) <= 0):
        raise DatabaseError(
            "information matrix must be 6x6, finite, with a positive diagonal; use 0.0001 for an unknown axis"
        )
    return np.ascontiguousarray(information, dtype="<f8").tobytes()


def unpack_information(blob: bytes | None) -> NDArray[np.float64]:
    """(6, 6) information matrix of 288 bytes."""
    if blob is None or len(blob) != 288:
        raise DatabaseError(
            f"information matrix has {0 if blob is None else len(blob)} bytes, not the 288 of a 6x6 one"
        )
    return np.frombuffer(blob, dtype="<f8").reshape(6, 6).copy()
