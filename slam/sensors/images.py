"""Strict decoding: an image file is whole and of the right kind, or it is refused."""

from __future__ import annotations

import zlib
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.errors import SourceError

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
_JPEG_END = b"\xff\xd9"
#: A stored depth that is no depth, as 0 is none.
_UNKNOWN = np.iinfo(np.uint16).max


def read_color(path: Path) -> NDArray[np.uint8]:
    """Colour image (H, W, 3) uint8, blue green red; a grey one is repeated in all three.

    Raises:
        SourceError: the file is absent, neither PNG nor JPEG, cut short or damaged.
    """
    image = cv2.imdecode(_whole(path), cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    if image is None:
        raise SourceError(f"{path}: damaged, the image can't be decoded; copy it again")
    return np.asarray(image, dtype=np.uint8)


def read_depth(path: Path) -> NDArray[np.uint16]:
    """Depth image (H, W) uint16 as stored, 0 where nothing was measured.

    Sensors also mark that by the largest value, 65535; a measurement that high would be one that is cut off there.

    Raises:
        SourceError: the file is absent, cut short or damaged, or not one channel of 16 bits.
    """
    image = cv2.imdecode(_whole(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise SourceError(f"{path}: damaged, the image can't be decoded; copy it again")
    if image.dtype != np.uint16 or image.ndim != 2:
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise SourceError(
            f"{path}: has {channels} channel(s) of {8 * image.dtype.itemsize} bits; "
            "depth is a PNG with one channel of 16 bits"
        )
    image[image == _UNKNOWN] = 0
    return np.asarray(image, dtype=np.uint16)


def _whole(path: Path) -> NDArray[np.uint8]:
    """The bytes of a file, its structure checked: OpenCV decodes one that was cut short without a word."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise SourceError(f"{path}: can't be read ({error.strerror})") from error
    if data.startswith(_PNG):
        _check_png(path, data)
    elif data.startswith(_JPEG):
        # Some cameras pad to a whole block after the end marker.
        if not data.rstrip(b"\0").endswith(_JPEG_END):
            raise SourceError(f"{path}: cut short after {len(data)} bytes (a JPEG ends with FF D9); copy it again")
    else:
        raise SourceError(f"{path}: {len(data)} bytes that are neither PNG nor JPEG")
    return np.frombuffer(data, dtype=np.uint8)


def _check_png(path: Path, data: bytes) -> None:
    """Walk the chunks (length, type, content, CRC-32 of both; PNG specification, section 5.3) up to IEND."""
    view = memoryview(data)
    at, kind = len(_PNG), b""
    while kind != b"IEND":
        length = int.from_bytes(view[at : at + 4], "big")
        end = at + 12 + length
        if end > len(data):
            raise SourceError(f"{path}: cut short after {len(data)} bytes (a PNG ends with IEND); copy it again")
        kind = bytes(view[at + 4 : at + 8])
        if zlib.crc32(view[at + 4 : end - 4]) != int.from_bytes(view[end - 4 : end], "big"):
            raise SourceError(f"{path}: damaged, the checksum of {kind!r} at byte {at} is wrong; copy it again")
        at = end
