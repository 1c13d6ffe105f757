"""Whatever the bytes of a blob, its decoder gives a value or one error of slamdeck's, in little memory."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable

import cv2
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from slam.camera import Camera
from slam.database import blobs
from slam.database.calibration import pack_camera, unpack_cameras
from slam.database.depth_codec import decode_rvl, encode_rvl
from slam.database.image_size import MAX_PIXELS, claimed_size
from slam.database.images import decode_color, decode_depth
from slam.database.scans import pack_scan, unpack_scan
from slam.database.statistics_text import pack_statistics, unpack_statistics
from slam.errors import DatabaseError
from slam.types import Scan

_RAMP = np.add.outer(np.arange(24, dtype=np.uint16), 40 * np.arange(32, dtype=np.uint16))
_CAMERA = Camera(64, 48, 52.5, 52.0, 31.5, 23.5)
_SCAN = pack_scan(Scan(np.ones((5, 3), np.float32), None))


def _image(extension: str, image: np.ndarray) -> bytes:
    return bytes(cv2.imencode(extension, image)[1])


def _png16(width: int, height: int) -> bytes:
    """A PNG whose header claims a size, with a right checksum."""
    whole = bytearray(_image(".png", _RAMP))
    whole[16:24] = struct.pack(">2I", width, height)
    whole[29:33] = struct.pack(">I", zlib.crc32(whole[12:29]))
    return bytes(whole)


#: Decoder and valid blobs of it.
DECODERS: dict[str, tuple[Callable[[bytes], object], list[bytes]]] = {
    "matrix": (
        blobs.unpack_matrix,
        [blobs.pack_matrix(_RAMP) or b"", blobs.pack_row(np.ones((4, 3), np.float32)) or b""],
    ),
    "information": (blobs.unpack_information, [blobs.pack_information(np.eye(6))]),
    "transform": (blobs.unpack_transform, [blobs.pack_transform(np.eye(4))]),
    "cameras": (unpack_cameras, [pack_camera(_CAMERA), 2 * pack_camera(_CAMERA)]),
    "rvl": (decode_rvl, [encode_rvl(_RAMP)]),
    "depth": (decode_depth, [_image(".png", _RAMP), encode_rvl(_RAMP)]),
    "colour": (decode_color, [_image(".jpg", np.dstack([_RAMP] * 3).astype(np.uint8)), _image(".png", _RAMP)]),
    "statistics": (unpack_statistics, [pack_statistics({"A/b/": 1.0, "C/d/ms": 2.5}) or b""]),
    "scan": (lambda blob: unpack_scan(blob, _SCAN[1]), [_SCAN[0] or b""]),
    "scan_info": (lambda blob: unpack_scan(_SCAN[0], blob), [_SCAN[1]]),
}


@st.composite
def damaged(draw: st.DrawFn) -> tuple[str, bytes]:
    """A decoder's name and a blob: a valid one changed here and there, cut or prolonged, or any bytes."""
    name = draw(st.sampled_from(sorted(DECODERS)))
    if draw(st.integers(0, 9)) == 0:
        return name, draw(st.binary(max_size=200))
    blob = bytearray(draw(st.sampled_from(DECODERS[name][1])))
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(blob) - 1))
        piece = draw(st.sampled_from([b"\0", b"\xff", b"\x7f", b"\x80", b"\xff\xff\xff\x7f", b"\0\0\xc0\x7f"]))
        blob[at : at + len(piece)] = piece
    if draw(st.booleans()):
        blob = blob[: draw(st.integers(0, len(blob)))]
    return name, bytes(blob) + draw(st.sampled_from([b"", b"\0", bytes(12), b"\xff" * 40]))


@given(damaged())
@example(("cameras", struct.pack("<11i", 0, 20, 0, 0, 64, 48, 9, 2**31 - 1, 9, 12, 12) + bytes(400)))
@example(("cameras", struct.pack("<10i", 0, 20, 0, 1, 2**28, 2**28, 0, 0, 0, 0) + bytes(400)))
@example(("matrix", zlib.compress(b"") + struct.pack("<3i", 2**31 - 1, 2**31 - 1, 6)))
@example(("matrix", zlib.compress(bytes(64)) + struct.pack("<3i", 4, 4, 2**31 - 1)))
@example(("rvl", struct.pack("<8s2I", b"DEPTHRVL", 2**32 - 1, 2**32 - 1)))
@example(("scan_info", b"\0"))
@example(("scan_info", np.full(19, np.nan, "<f4").tobytes()))
@example(("scan_info", np.full(19, np.inf, "<f4").tobytes()))
def test_any_bytes_are_a_value_or_one_error(case: tuple[str, bytes]) -> None:
    name, blob = case
    try:
        DECODERS[name][0](blob)
    except DatabaseError as error:
        assert str(error)
        assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("width", "height"), [(60_000, 60_000), (1, 2**31), (2**31, 1), (0, 5), (MAX_PIXELS // 2 + 1, 2)]
)
def test_an_image_that_claims_too_much_is_never_decoded(
    width: int, height: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cv2.imdecode", None)
    for decode in (decode_color, decode_depth):
        with pytest.raises(DatabaseError, match=r"claims|neither"):
            decode(_png16(width, height))


def _jpeg(*pieces: bytes) -> bytes:
    """A JPEG of 60,000 by 60,000 pixels with something before the frame that says so."""
    return b"\xff\xd8" + b"".join(pieces) + b"\xff\xc0\x00\x11\x08\xea\x60\xea\x60\x03" + bytes(9)


_SMALL_FRAME = b"\xff\xc0\x00\x11\x08\x00\x08\x00\x08\x03" + bytes(9)


@pytest.mark.parametrize(
    "before",
    [
        b"",
        b"\x00\x17garbage",
        b"\xff\xff\xff",
        b"\xff\x01",
        b"\xff\xd0",
        b"\xff\xe0\x00\x04\xff\xc0",
        b"\xff\xe1\x00\x15" + _SMALL_FRAME,
        b"\xff\xfe\x00\x00",
    ],
)
def test_the_size_of_a_jpeg_is_the_one_its_decoder_finds(before: bytes) -> None:
    assert claimed_size(_jpeg(before)) == (60_000, 60_000)


def test_other_formats_of_images_are_not_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cv2.imdecode", None)
    for extension in (".bmp", ".tiff", ".webp", ".pgm"):
        with pytest.raises(DatabaseError, match="neither a JPEG nor a PNG"):
            decode_color(_image(extension, np.zeros((8, 8, 3), np.uint8)))


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"fx": 0.0}, "fx = 0"),
        ({"fy": np.nan}, "fy = nan"),
        ({"fx": 1e30}, "fx = 1e\\+30"),
        ({"cx": np.inf}, "cx = inf"),
        ({"width": -5}, "width of -5"),
        ({"height": 10**9}, "height of 1000000000"),
    ],
)
def test_cameras_that_do_not_exist_are_refused(changed: dict[str, float], says: str) -> None:
    values = {"width": 64, "height": 48, "fx": 52.5, "fy": 52.0, "cx": 31.5, "cy": 23.5} | changed
    header = struct.pack("<11i", 0, 20, 0, 0, int(values["width"]), int(values["height"]), 9, 0, 0, 0, 12)
    numbers = [values["fx"], 0, values["cx"], 0, values["fy"], values["cy"], 0, 0, 1]
    with pytest.raises(DatabaseError, match=says):
        unpack_cameras(header + np.array(numbers, "<f8").tobytes() + blobs.pack_transform(np.eye(4)))


@pytest.mark.parametrize("entry", [0.0, -1.0, np.nan, np.inf, 1e200])
def test_information_that_weighs_nothing_right_is_refused(entry: float) -> None:
    information = np.eye(6)
    information[3, 3] = entry
    with pytest.raises(DatabaseError, match="must be finite, with positive numbers"):
        blobs.unpack_information(information.astype("<f8").tobytes())


@pytest.mark.parametrize("entry", [1e30, np.nan, np.inf, -np.inf])
def test_what_is_no_rigid_motion_is_no_pose(entry: float) -> None:
    for at in ((0, 0), (2, 3)):
        T_a_b = np.eye(4)
        T_a_b[at] = entry
        assert blobs.unpack_transform(blobs.pack_transform(T_a_b)) is None
        assert blobs.unpack_pose(blobs.pack_pose(T_a_b)) is None
