"""Calibration records, byte for byte."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from slam.camera import T_BASE_OPTICAL, Camera
from slam.database.calibration import is_stereo, pack_camera, unpack_cameras
from slam.errors import DatabaseError

CAMERA = Camera(640, 480, 525.0, 524.0, 319.5, 239.5)
K = [525.0, 0, 319.5, 0, 524.0, 239.5, 0, 0, 1]
P = [400.0, 0, 300.0, -38.8, 0, 410.0, 200.0, 0, 0, 0, 1, 0]
T = T_BASE_OPTICAL[:3].ravel().tolist()


def mono(k: list[float] = K, d: int = 5, r: int = 9, p: list[float] = P, t: list[float] = T) -> bytes:
    """A record with distortion, rectification and projection, as cameras with a driver have."""
    header = struct.pack("<11i", 0, 21, 1, 0, 640, 480, len(k), d, r, len(p), len(t))
    numbers = [*k, *([0.1] * d), *np.eye(3).ravel()[:r], *p]
    return header + struct.pack(f"<{len(numbers)}d", *numbers) + struct.pack(f"<{len(t)}f", *t)


def stereo(left: bytes, right: bytes) -> bytes:
    return struct.pack("<10i", 0, 21, 1, 1, 9, 3, 0, 0, len(left), len(right)) + bytes(8 * 12) + left + right


def test_a_record_has_the_format_s_layout() -> None:
    expected = (
        struct.pack("<11i", 0, 20, 0, 0, 640, 480, 9, 0, 0, 0, 12) + struct.pack("<9d", *K) + struct.pack("<12f", *T)
    )
    assert pack_camera(CAMERA) == expected
    assert len(mono()) == 372


def test_the_projection_counts_when_there_is_one() -> None:
    (camera,) = unpack_cameras(mono())
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (400.0, 410.0, 300.0, 200.0)
    (camera,) = unpack_cameras(mono(p=[]))
    np.testing.assert_array_equal(camera.K, CAMERA.K)
    np.testing.assert_array_equal(camera.T_base_cam, T_BASE_OPTICAL)


def test_several_cameras_and_stereo() -> None:
    assert len(unpack_cameras(mono() + pack_camera(CAMERA))) == 2
    blob = stereo(mono(p=[]), mono())
    assert is_stereo(blob)
    assert not is_stereo(mono())
    (camera,) = unpack_cameras(blob)
    assert camera.fx == 525.0


@pytest.mark.parametrize(
    ("blob", "says"),
    [
        (b"12345", "no camera"),
        (mono()[:40], "shorter than a camera's header"),
        (mono()[:-1], "does not hold the 372"),
        (mono() + b"x", "no camera"),
        (struct.pack("<11i", 0, 21, 1, 0, 640, 480, 7, 0, 0, 0, 12) + bytes(500), "7 numbers for K, not 9"),
        (struct.pack("<11i", 0, 21, 1, 0, 640, 480, 9, -5, 0, 0, 12) + bytes(500), "does not hold"),
        (struct.pack("<11i", 0, 21, 1, 2, 640, 480, 9, 0, 0, 0, 12) + bytes(500), "type 2"),
        (mono(k=[], p=[]), "lacks the intrinsics"),
        (mono(t=[0.0] * 12), "lacks the intrinsics or the local transform"),
        (stereo(mono(), mono())[:60], "does not hold"),
        (stereo(mono(), mono())[:20], "shorter than a stereo header"),
        (struct.pack("<10i", 0, 21, 1, 1, 0, 0, 0, 0, -9, 9), "does not hold"),
    ],
)
def test_damage_is_refused(blob: bytes, says: str) -> None:
    with pytest.raises(DatabaseError, match=says):
        unpack_cameras(blob)


def test_a_centre_that_rtabmap_takes_for_none_is_refused() -> None:
    with pytest.raises(DatabaseError, match=r"centre \(0, 239\.5\) must be positive"):
        pack_camera(Camera(640, 480, 525.0, 525.0, 0.0, 239.5))
