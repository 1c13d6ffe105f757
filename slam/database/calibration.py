"""The calibration blob of a node: one record for each camera (RTAB-Map 0.18 and later)."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database.blobs import pack_transform, unpack_transform
from slam.database.camera_check import check_length, checked_camera
from slam.errors import DatabaseError

_HEADER = struct.Struct("<11i")
_STEREO_HEADER = struct.Struct("<10i")
_VERSION = (0, 20, 0)
_MONO, _STEREO = 0, 1
_SIZES = {"K": (0, 9), "R": (0, 9), "P": (0, 12), "local transform": (0, 12)}


def pack_camera(camera: Camera) -> bytes:
    """Record of one rectified camera: the size, K and the pose of the optical frame in the base frame (164 bytes)."""
    if not (camera.cx > 0 and camera.cy > 0):
        raise DatabaseError(
            f"camera centre ({camera.cx:g}, {camera.cy:g}) must be positive: RTAB-Map takes others for no camera"
        )
    return pack_record(camera)


def pack_record(camera: Camera, baseline: float | None = None) -> bytes:
    """Record of a camera as it is; with a ``baseline`` in metres, of the right one of a stereo pair."""
    projection = b""
    if baseline is not None:
        P = np.hstack([camera.K, [[-camera.fx * baseline], [0.0], [0.0]]])
        projection = P.astype("<f8").tobytes()
    header = _HEADER.pack(*_VERSION, _MONO, camera.width, camera.height, 9, 0, 0, len(projection) // 8, 12)
    return header + camera.K.astype("<f8").tobytes() + projection + pack_transform(camera.T_base_cam)


def pack_stereo(left: Camera, baseline: float) -> bytes:
    """Record of a rectified stereo pair: the left camera, and a right one ``baseline`` metres beside it."""
    records = pack_record(left), pack_record(left, baseline)
    header = _STEREO_HEADER.pack(*_VERSION, _STEREO, 0, 0, 0, 0, *(len(record) for record in records))
    return header + b"".join(records)


def unpack_cameras(blob: bytes) -> tuple[Camera, ...]:
    """The cameras of a node, in the order of the tiles of its image; for stereo, the left one of each pair.

    Raises:
        DatabaseError: the blob is damaged.
    """
    return tuple(camera for camera, _ in unpack_rig(blob))


def unpack_rig(blob: bytes) -> tuple[tuple[Camera, float | None], ...]:
    """The cameras of a node, each with the baseline of its stereo pair in metres; None where depth was measured.

    Raises:
        DatabaseError: the blob is damaged.
    """
    rig: list[tuple[Camera, float | None]] = []
    check_length(blob)
    while blob:
        if len(blob) < 16:
            raise DatabaseError(f"calibration ends with {len(blob)} bytes that are no camera: it is damaged")
        camera, baseline, size = (_unpack_stereo if is_stereo(blob) else _unpack_single)(blob)
        rig.append((camera, baseline))
        blob = blob[size:]
    return tuple(rig)


def is_stereo(blob: bytes) -> bool:
    """Whether the depth column of this node holds the right image of a stereo pair."""
    return len(blob) >= 16 and struct.unpack_from("<i", blob, 12)[0] == _STEREO


def _unpack_single(blob: bytes) -> tuple[Camera, None, int]:
    camera, _, size = _unpack_mono(blob)
    return camera, None, size


def _unpack_mono(blob: bytes) -> tuple[Camera, float, int]:
    """Camera, how far beside the left one of its pair it is as the projection has it (-baseline), and its bytes."""
    if len(blob) < _HEADER.size:
        raise DatabaseError(f"calibration of {len(blob)} bytes is shorter than a camera's header of {_HEADER.size}")
    *_, kind, width, height, n_k, n_d, n_r, n_p, n_t = _HEADER.unpack_from(blob)
    for (name, allowed), count in zip(_SIZES.items(), (n_k, n_r, n_p, n_t), strict=True):
        if count not in allowed:
            raise DatabaseError(f"calibration has {count} numbers for {name}, not {allowed[1]}: it is damaged")
    size = _HEADER.size + 8 * (n_k + n_d + n_r + n_p) + 4 * n_t
    if kind != _MONO or n_d < 0 or len(blob) < size:
        raise DatabaseError(f"calibration of {len(blob)} bytes (type {kind}) does not hold the {size} it announces")
    numbers = np.frombuffer(blob, dtype="<f8", count=n_k + n_d + n_r + n_p, offset=_HEADER.size)
    projection = numbers[n_k + n_d + n_r :].reshape(-1, 4) if n_p else numbers[:n_k].reshape(-1, 3)
    T_base_cam = unpack_transform(blob[size - 48 : size]) if n_t else np.eye(4)
    camera = _camera(width, height, projection, T_base_cam)
    return camera, float(projection[0, 3]) / camera.fx if n_p and camera.fx else 0.0, size


def _camera(width: int, height: int, projection: NDArray[np.float64], T_base_cam: NDArray[np.float64] | None) -> Camera:
    if projection.size == 0 or T_base_cam is None:
        raise DatabaseError("calibration lacks the intrinsics or the local transform: this node has no usable camera")
    fx, fy, cx, cy = projection[0, 0], projection[1, 1], projection[0, 2], projection[1, 2]
    return checked_camera(Camera(width, height, float(fx), float(fy), float(cx), float(cy), T_base_cam))


def _unpack_stereo(blob: bytes) -> tuple[Camera, float, int]:
    if len(blob) < _STEREO_HEADER.size:
        raise DatabaseError(
            f"calibration of {len(blob)} bytes is shorter than a stereo header of {_STEREO_HEADER.size}"
        )
    header = _STEREO_HEADER.unpack_from(blob)
    start = _STEREO_HEADER.size + 8 * sum(header[4:8])
    size = start + header[8] + header[9]
    if min(header[4:]) < 0 or len(blob) < size:
        raise DatabaseError(f"stereo calibration of {len(blob)} bytes does not hold the {size} it announces")
    left, left_shift, _ = _unpack_mono(blob[start : start + header[8]])
    _, right_shift, _ = _unpack_mono(blob[start + header[8] : size])
    return left, left_shift - right_shift, size
