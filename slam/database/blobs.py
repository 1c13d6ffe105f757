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
#: Bounds of what is taken for a pose; coordinates of the world (UTM) stay below a tenth of the distance.
_LARGEST_COSINE, _VOLUME_SLACK, _FARTHEST_M = 1.1, 0.2, 1e8
#: Entries of information from which on sums and squares of them overflow.
_MOST_INFORMATION = 1e100
#: Bytes from which a matrix is taken for a damaged one: the grid of a map of 800 m by 800 m at 5 cm stays below.
MAX_BYTES = 1 << 28
#: The same of one node's cloud or local grid (a hundred thousand points have 3 MB), and of one update's statistics.
MAX_CLOUD_BYTES, MAX_STATISTICS_BYTES = 1 << 26, 1 << 18
#: Blobs of that many bytes or fewer count as absent: old writers stored four zero bytes for nothing.
NOTHING = 4
#: Of a transform, of a pose in slamdeck's own tables, and of an information matrix.
TRANSFORM_BYTES, POSE_BYTES, INFORMATION_BYTES = 48, 96, 288


def pack_matrix(matrix: NDArray[np.generic], *, level: int = -1) -> bytes | None:
    """Blob of a (rows, columns) or (rows, columns, channels) matrix; None (SQL NULL) when it is empty."""
    if matrix.size == 0:
        return None
    rows, columns, *channels = matrix.shape
    dtype = matrix.dtype.newbyteorder("<")
    kind = _DTYPES.index(dtype) + 8 * ((channels[0] if channels else 1) - 1)
    trailer = np.array([rows, columns, kind], dtype="<i4").tobytes()
    return zlib.compress(np.ascontiguousarray(matrix, dtype=dtype).tobytes(), level) + trailer


def unpack_matrix(blob: bytes | None, most: int = MAX_BYTES) -> NDArray[np.generic] | None:
    """Matrix (rows, columns) or (rows, columns, channels) of a blob; None for NULL and for the old four-byte nothing.

    Args:
        blob: the column of the table.
        most: bytes of the largest matrix that is made of it.

    Raises:
        DatabaseError: the blob is damaged, or claims a size that no map has.
    """
    if blob is None:
        return None
    if not isinstance(blob, bytes):
        raise DatabaseError(f"matrix is {str(blob)[:40]!r}, not a blob")
    if len(blob) <= NOTHING:
        return None
    if len(blob) <= _TRAILER:
        raise DatabaseError(f"matrix blob of {len(blob)} bytes is too short: a stream and three integers were expected")
    rows, columns, kind = (int(v) for v in np.frombuffer(blob[-_TRAILER:], dtype="<i4"))
    depth, channels = kind % 8, kind // 8 + 1
    if rows <= 0 or columns <= 0 or kind < 0 or depth >= len(_DTYPES):
        raise DatabaseError(f"matrix blob says {rows} rows, {columns} columns, type {kind}, which no matrix has")
    dtype = _DTYPES[depth]
    size = rows * columns * channels * dtype.itemsize
    if size > most:
        raise DatabaseError(f"matrix blob claims {size} bytes, more than the {most} that any map needs: it is damaged")
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
    if not isinstance(blob, bytes) or len(blob) != TRANSFORM_BYTES:
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
    null = bytes(POSE_BYTES)
    raw = b"".join(blob if isinstance(blob, bytes) and len(blob) == POSE_BYTES else null for blob in blobs)
    stack = stack_rows(np.frombuffer(raw, dtype="<f8"))
    known = np.isfinite(stack[:, 0, 0])
    return [T_a_b if ok else None for T_a_b, ok in zip(stack, known.tolist(), strict=True)]


def stack_transforms(blobs: Sequence[bytes | None]) -> NDArray[np.float64]:
    """Poses (N, 4, 4) of transform blobs; NaN where ``unpack_transform`` gives None."""
    null = bytes(TRANSFORM_BYTES)
    raw = b"".join(blob if isinstance(blob, bytes) and len(blob) == TRANSFORM_BYTES else null for blob in blobs)
    return stack_rows(np.frombuffer(raw, dtype="<f4"))


def stack_rows(numbers: NDArray[np.floating]) -> NDArray[np.float64]:
    """Poses (N, 4, 4) of 12 N numbers, three rows each; NaN for the null transform and for what is no rigid motion."""
    rows = numbers.reshape(-1, 3, 4)
    stack = np.zeros((len(rows), 4, 4))
    stack[:, :3] = rows
    stack[:, 3, 3] = 1.0
    stack[~_are_rigid(stack)] = np.nan
    return stack


def _are_rigid(stack: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which of (N, 4, 4) can be poses: RTAB-Map's rotations are off by roundings, damaged ones by anything."""
    R: NDArray[np.float64] = stack[:, :3, :3]
    turned = (np.abs(R) <= _LARGEST_COSINE).all(axis=(1, 2))
    near: NDArray[np.bool_] = np.logical_and(turned, (np.abs(stack[:, :3, 3]) < _FARTHEST_M).all(axis=1))
    volumes = np.linalg.det(np.where(near[:, np.newaxis, np.newaxis], R, 0.0))
    rigid: NDArray[np.bool_] = np.logical_and(near, np.abs(volumes - 1.0) < _VOLUME_SLACK)
    return rigid


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
    """(6, 6) information matrix of 288 bytes.

    Raises:
        DatabaseError: it is of another size, not finite, or has a diagonal that is not positive, which RTAB-Map refuses
            to load.
    """
    if not isinstance(blob, bytes) or len(blob) != INFORMATION_BYTES:
        size = len(blob) if isinstance(blob, bytes) else 0
        raise DatabaseError(f"information matrix has {size} bytes, not the {INFORMATION_BYTES} of a 6x6 one")
    information = stack_informations([blob])[0]
    check_information(information)
    return np.asarray(information)


def stack_informations(blobs: Sequence[bytes | None]) -> NDArray[np.float64]:
    """Matrices (N, 6, 6) of blobs of 288 bytes; zeros for NULL."""
    null = bytes(INFORMATION_BYTES)
    numbers = np.frombuffer(b"".join(null if blob is None else blob for blob in blobs), dtype="<f8")
    return np.array(numbers, dtype=np.float64).reshape(-1, 6, 6)


def sound_informations(stack: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which (N,) of matrices (N, 6, 6) RTAB-Map would load."""
    positive = (np.diagonal(stack, axis1=1, axis2=2) > 0).all(axis=1)
    return np.logical_and(positive, (np.abs(stack) < _MOST_INFORMATION).all(axis=(1, 2)))


def check_information(information: NDArray[np.float64]) -> None:
    """Refuse a matrix (6, 6) that RTAB-Map would not load; DatabaseError with the entry that is wrong."""
    diagonal = information.diagonal()
    if diagonal.min() > 0 and np.abs(information).max() < _MOST_INFORMATION:
        return
    bad = information[~(np.abs(information) < _MOST_INFORMATION)].tolist() or [float(diagonal.min())]
    raise DatabaseError(f"information matrix has {bad[0]:g}: it must be finite, with positive numbers on its diagonal")
