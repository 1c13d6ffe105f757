"""What older versions of RTAB-Map stored, in today's blobs.

These functions are given to SQLite, which tells nothing of an exception but that there was one. So what can't be
understood is handed on as it is: whoever decodes it says what is wrong with it.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database.blobs import (
    pack_information,
    pack_row,
    pack_transform,
    stack_rows,
    unpack_transform,
)
from slam.database.calibration import pack_record, pack_stereo
from slam.database.scans import pack_scan_info

#: Numbers of one camera without and with the image size, and of a stereo pair likewise (which has a baseline more).
_MONO, _MONO_SIZED, _STEREO, _STEREO_SIZED = 16, 18, 17, 19
_POSE = 12


def register(driver: sqlite3.Connection) -> None:
    """Make the conversions known to a connection, by the names that the views of ``old_schema`` use."""
    conversions: tuple[tuple[str, int, Callable[..., bytes | None]], ...] = (
        ("deck_orthonormal", 1, orthonormal),
        ("deck_information", 2, information),
        ("deck_calibration", 2, calibration),
        ("deck_depth_calibration", 5, depth_calibration),
        ("deck_focal_calibration", 2, focal_calibration),
        ("deck_scan_info", 1, scan_info),
        ("deck_scan_limits", 2, scan_limits),
        ("deck_text", 1, text),
    )
    for name, arguments, function in conversions:
        driver.create_function(name, arguments, function, deterministic=True)


def orthonormal(blob: bytes | None) -> bytes | None:
    """A transform whose rotation is one: before 0.15.2 they may be slightly off (nearest one, by SVD)."""
    T_a_b = unpack_transform(blob)
    if T_a_b is None:
        return blob
    u, _, vt = np.linalg.svd(T_a_b[:3, :3])
    T_a_b[:3, :3] = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
    return pack_transform(T_a_b)


def information(rotation: float | None, translation: float | None) -> bytes:
    """Information matrix of the variances that links had before 0.13.0; one that is none counts as 1, unknown."""
    variances = [v if isinstance(v, float | int) and 0 < v < np.inf else 1.0 for v in (translation, rotation)]
    return pack_information(np.diag(1.0 / np.repeat(variances, 3)))


def calibration(blob: bytes | None, sized: int) -> bytes | None:
    """Today's records of the calibration of 0.10.0 to 0.17; ``sized`` from 0.11.2 on, which has the image size."""
    numbers = _floats(blob)
    count = 0 if numbers is None else len(numbers)
    if numbers is None or not count:
        return blob
    if count in (_STEREO, _STEREO_SIZED):
        camera = _camera(np.delete(numbers, 4))
        return pack_stereo(camera, float(numbers[4]))
    for length in (_MONO_SIZED, _MONO) if sized else (_MONO, _MONO_SIZED):
        if count % length == 0:
            return b"".join(pack_record(_camera(part)) for part in numbers.reshape(-1, length))
    return blob


def depth_calibration(
    fx: float | None, fy: float | None, cx: float | None, cy: float | None, local_transform: bytes | None
) -> bytes | None:
    """Today's record of the columns of 0.7.0 to 0.9: an fy below 1 is the baseline of a stereo pair."""
    if not fx or fy is None or not isinstance(local_transform, bytes):
        return None
    pose = _floats(local_transform)
    if pose is None or len(pose) != _POSE:
        return None
    stereo = fy < 1.0
    camera = _camera(np.concatenate([[fx, fx if stereo else fy, cx or 0.0, cy or 0.0], pose]))
    return pack_stereo(camera, fy) if stereo else pack_record(camera)


def focal_calibration(constant: float | None, local_transform: bytes | None) -> bytes | None:
    """Today's record of the column ``constant`` before 0.7.0: one over the focal length, the centre unknown."""
    return depth_calibration(1.0 / constant, 1.0 / constant, 0.0, 0.0, local_transform) if constant else None


def scan_info(blob: bytes | None) -> bytes | None:
    """Today's 19 numbers of the 14 or 15 before 0.18.0: most points, range, the format from 0.16.1 on, transform."""
    numbers = _floats(blob)
    if numbers is None or len(numbers) not in (14, 15):
        return blob
    kind = int(numbers[2]) if len(numbers) == 15 else 0
    (T_base_scan,) = stack_rows(numbers[-_POSE:])
    return pack_scan_info(kind, int(numbers[0]), T_base_scan, range_max=float(numbers[1]))


def scan_limits(points: int | None, range_max: float | None) -> bytes:
    """Today's 19 numbers of the columns of 0.8.11 to 0.11.9, where the scan is in the base frame."""
    return pack_scan_info(0, points or 0, np.eye(4), range_max=range_max or 0.0)


def text(value: str | bytes | None) -> bytes | None:
    """Text or raw bytes as the matrix of signed bytes that holds them today, text with its final NUL."""
    raw = value.encode() + b"\0" if isinstance(value, str) else value
    return pack_row(np.frombuffer(raw, dtype=np.int8)) if raw else None


def _floats(blob: bytes | None) -> NDArray[np.float32] | None:
    return np.frombuffer(blob, dtype="<f4") if isinstance(blob, bytes) and len(blob) % 4 == 0 else None


def _camera(numbers: NDArray[np.floating]) -> Camera:
    """Camera of fx fy cx cy, the size where it is there, and 12 numbers of the pose (NaN becomes RTAB-Map's null)."""
    fx, fy, cx, cy, *size = (float(v) for v in _finite(numbers[:-_POSE]))
    width, height = (int(v) for v in size) if size else (0, 0)
    (T_base_cam,) = stack_rows(numbers[-_POSE:])
    return Camera(width, height, fx, fy, cx, cy, np.nan_to_num(T_base_cam))


def _finite(numbers: NDArray[np.floating]) -> Iterator[float]:
    return iter(np.nan_to_num(numbers, posinf=0.0, neginf=0.0).tolist())
