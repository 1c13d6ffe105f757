"""Clouds as RTAB-Map stores laser scans: a matrix of points, and 19 numbers about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.database.blobs import MAX_CLOUD_BYTES, pack_row, stack_rows, unpack_matrix
from slam.errors import DatabaseError
from slam.geometry import transform
from slam.types import Scan

#: Format number -> whether points have a z, and the channel where their normal begins (0 for none).
_FORMATS = {
    **dict.fromkeys((1, 2), (False, 0)),
    3: (False, 2),
    4: (False, 3),
    **dict.fromkeys((5, 6, 7, 11, 12), (True, 0)),
    8: (True, 3),
    **dict.fromkeys((9, 10), (True, 4)),
}
#: Format number -> name, channel of the intensity (0 for none), and of the colour as bits of blue, green and red.
_CHANNELS = {
    1: ("XY", 0, 0),
    2: ("XY, intensity", 2, 0),
    3: ("XY, normals", 0, 0),
    4: ("XY, intensity, normals", 2, 0),
    5: ("XYZ", 0, 0),
    6: ("XYZ, intensity", 3, 0),
    7: ("XYZ, colour", 0, 3),
    8: ("XYZ, normals", 0, 0),
    9: ("XYZ, intensity, normals", 3, 0),
    10: ("XYZ, colour, normals", 0, 3),
    11: ("XYZ, intensity, time", 3, 0),
    12: ("XYZ, intensity, ring, time", 3, 0),
}
#: Channels -> format, for scans that don't say theirs.
_GUESSED = {2: 1, 3: 5, 4: 7, 5: 3, 6: 8, 7: 10}
_XYZ, _XYZ_NORMAL = 5, 8
_INFO = 19
_LOCAL_TRANSFORM = 7


@dataclass(frozen=True, slots=True, eq=False)
class StoredScan:
    """A scan with all that is stored of it; numbers are 0 where the file does not say.

    Attributes:
        scan: its points in the base frame.
        intensities: (N,) of each point, None where none are stored.
        colours: (N, 3) red first, None where none are stored.
        format: the channels of a point, by name.
        range_m: least and greatest distance that the scanner measures.
        angles_rad: first, last and step of a planar scanner.
        most: points of a whole sweep.
        T_base_scan: (4, 4) where the scanner is.
    """

    scan: Scan
    intensities: NDArray[np.float32] | None
    colours: NDArray[np.uint8] | None
    format: str
    range_m: tuple[float, float]
    angles_rad: tuple[float, float, float]
    most: int
    T_base_scan: NDArray[np.float64]


def pack_scan(scan: Scan) -> tuple[bytes | None, bytes]:
    """The columns ``scan`` and ``scan_info`` of a cloud in the base frame."""
    columns, kind = [scan.points_base], _XYZ
    if scan.normals_base is not None:
        columns, kind = [scan.points_base, scan.normals_base], _XYZ_NORMAL
    return pack_row(np.hstack(columns).astype(np.float32)), pack_scan_info(kind, len(scan), np.eye(4))


def pack_scan_info(kind: int, points: int, T_base_scan: NDArray[np.float64], *, range_max: float = 0.0) -> bytes:
    """The column ``scan_info``: format, range in metres, most points, and where the scanner is."""
    info = np.zeros(_INFO, np.float32)
    info[0], info[2], info[6] = kind, range_max, points
    info[_LOCAL_TRANSFORM:] = T_base_scan[:3].reshape(-1)
    return info.astype("<f4").tobytes()


def unpack_scan(blob: bytes | None, info_blob: bytes | None) -> Scan | None:
    """The cloud of a node in its base frame, points of a planar laser at its height; None when there is none.

    Raises:
        DatabaseError: a blob is damaged, or of a format that is not known.
    """
    stored = unpack_stored_scan(blob, info_blob)
    return None if stored is None else stored.scan


def unpack_stored_scan(blob: bytes | None, info_blob: bytes | None) -> StoredScan | None:
    """The same with intensities, colours, and what is known of the scanner; raises as ``unpack_scan``."""
    matrix = unpack_matrix(blob, MAX_CLOUD_BYTES)
    if matrix is None:
        return None
    with np.errstate(over="ignore"):
        rows = matrix.reshape(-1, matrix.shape[2] if matrix.ndim == 3 else 1).astype(np.float32)
    if info_blob and (not isinstance(info_blob, bytes) or len(info_blob) % 4):
        raise DatabaseError(f"scan_info has {len(info_blob)} bytes, which are no numbers of four bytes")
    info = np.frombuffer(info_blob, "<f4") if info_blob else np.zeros(0, np.float32)
    if len(info) not in (0, _INFO):
        raise DatabaseError(f"scan_info has {len(info)} numbers, not the {_INFO} that RTAB-Map writes")
    kind = int(info[0]) if len(info) and np.isfinite(info[0]) else 0
    kind = kind or _GUESSED.get(rows.shape[1], 0)
    if kind not in _FORMATS:
        raise DatabaseError(f"scan of format {kind} with {rows.shape[1]} channels is not known")
    T_base_scan = _local_transform(info)
    scan, kept = _in_base(rows, *_FORMATS[kind], T_base_scan)
    name, intensity, colour = _CHANNELS[kind]
    told = np.nan_to_num(info[1:_LOCAL_TRANSFORM], posinf=0.0, neginf=0.0) if len(info) else np.zeros(6)
    near, far, first, last, step, most = (float(value) for value in told)
    return StoredScan(
        scan=scan,
        intensities=rows[kept, intensity] if 0 < intensity < rows.shape[1] else None,
        colours=_colours(rows[kept, colour]) if 0 < colour < rows.shape[1] else None,
        format=name,
        range_m=(near, far),
        angles_rad=(first, last, step),
        most=int(most),
        T_base_scan=T_base_scan,
    )


def _colours(channel: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Colours (N, 3), red first, of the bits of numbers (N,): blue lowest."""
    bits = np.ascontiguousarray(channel).view(np.uint32)
    return np.column_stack([(bits >> shift) & 255 for shift in (16, 8, 0)]).astype(np.uint8)


def _local_transform(info: NDArray[np.float32]) -> NDArray[np.float64]:
    if len(info) == 0:
        return np.eye(4)
    T_base_scan = stack_rows(info[_LOCAL_TRANSFORM:])[0]
    return T_base_scan if np.isfinite(T_base_scan).all() else np.eye(4)


def _in_base(
    rows: NDArray[np.float32], solid: bool, normal: int, T_base_scan: NDArray[np.float64]
) -> tuple[Scan, NDArray[np.bool_]]:
    """The finite points in the base frame, and which of the rows they are."""
    if rows.shape[1] < max(3 if solid else 2, normal + 3 if normal else 0):
        raise DatabaseError(f"scan has {rows.shape[1]} channels, too few for its format")
    points = rows[:, :3].copy() if solid else np.column_stack([rows[:, :2], np.zeros(len(rows), np.float32)])
    kept = np.isfinite(points).all(axis=1)
    normals = rows[:, normal : normal + 3] if normal else None
    if normals is not None:
        kept &= np.isfinite(normals).all(axis=1)
    if not np.array_equal(T_base_scan, np.eye(4)):
        points = transform(T_base_scan, points).astype(np.float32)
        normals = None if normals is None else (normals @ T_base_scan[:3, :3].T).astype(np.float32)
    return Scan(points[kept], None if normals is None else np.ascontiguousarray(normals[kept])), np.asarray(kept)
