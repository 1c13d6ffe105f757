"""RVL: lossless 16-bit depth images (Wilson, "Fast Lossless Depth Image Compression", 2017), in RTAB-Map's wrapping.

The blob is the magic ``DEPTHRVL``, the width and the height as uint32, then 32-bit words of eight nibbles, most
significant first. A number is a series of nibbles, its low three bits first, bit 3 set when more follow. The stream
repeats: count of zeros, count of non-zeros, and for each non-zero pixel the zig-zag coded difference to the previous
non-zero one (0 at the start, carried on over zeros and rows).
"""

from __future__ import annotations

import struct

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.database.image_size import MAX_PIXELS, MAX_SIDE
from slam.database.images import RVL_MAGIC as MAGIC
from slam.errors import DatabaseError

_HEADER = struct.Struct("<8s2I")


def encode_rvl(depth_mm: NDArray[np.uint16]) -> bytes:
    """RVL blob of a depth image (H, W) in millimetres."""
    height, width = depth_mm.shape
    # The worst pixel costs 6 nibbles (17 bits of zig-zag); one alone between zeros adds 2 and has a zero beside it.
    words = np.empty(depth_mm.size + 2, dtype=np.uint32)
    count = _compress(depth_mm.astype(np.int32).reshape(-1), words)
    return _HEADER.pack(MAGIC, width, height) + words[:count].astype("<u4").tobytes()


def decode_rvl(blob: bytes) -> NDArray[np.uint16]:
    """Depth image (H, W) in millimetres of an RVL blob.

    Raises:
        DatabaseError: the blob is damaged or cut off.
    """
    if len(blob) < _HEADER.size or not blob.startswith(MAGIC):
        raise DatabaseError(
            f"depth image of {len(blob)} bytes is no RVL image: it must start with {MAGIC.decode()} and its size"
        )
    _, width, height = _HEADER.unpack_from(blob)
    if not 0 < width * height <= MAX_PIXELS or max(width, height) > MAX_SIDE:
        raise DatabaseError(f"RVL depth image claims {width}x{height} pixels: it is damaged")
    body = blob[_HEADER.size :]
    words = np.frombuffer(body, dtype="<u4", count=len(body) // 4).astype(np.int64)
    pixels = np.zeros(width * height, dtype=np.uint16)
    if not _decompress(words, pixels):
        raise DatabaseError(f"RVL depth image of {width}x{height} pixels is cut off or damaged ({len(blob)} bytes)")
    return pixels.reshape(height, width)


@njit(cache=True, nogil=True)
def _put(words: NDArray[np.uint32], at: int, value: int) -> int:
    """Append a number at nibble ``at``; the nibble after it."""
    while True:
        nibble = value & 7
        value >>= 3
        if value:
            nibble |= 8
        word, slot = at >> 3, at & 7
        if slot == 0:
            words[word] = 0
        words[word] |= np.uint32(nibble << (28 - 4 * slot))
        at += 1
        if not value:
            return at


@njit(cache=True, nogil=True)
def _compress(pixels: NDArray[np.int32], words: NDArray[np.uint32]) -> int:
    at, i, previous, n = 0, 0, 0, len(pixels)
    while i < n:
        start = i
        while i < n and pixels[i] == 0:
            i += 1
        at = _put(words, at, i - start)
        end = i
        while end < n and pixels[end] != 0:
            end += 1
        at = _put(words, at, end - i)
        while i < end:
            current = int(pixels[i])
            delta = current - previous
            at = _put(words, at, (delta << 1) ^ (delta >> 63))
            previous = current
            i += 1
    return (at + 7) >> 3


@njit(cache=True, nogil=True)
def _get(words: NDArray[np.int64], at: int) -> tuple[int, int]:
    """Number at nibble ``at`` and the nibble after it; -1 when the words end before it or it is too large."""
    value, bits = 0, 0
    while at < 8 * len(words) and bits < 33:
        nibble = (int(words[at >> 3]) >> (28 - 4 * (at & 7))) & 15
        at += 1
        value |= (nibble & 7) << bits
        if nibble < 8:
            return value, at
        bits += 3
    return -1, at


@njit(cache=True, nogil=True)
def _decompress(words: NDArray[np.int64], pixels: NDArray[np.uint16]) -> bool:
    at, i, previous, n = 0, 0, 0, len(pixels)
    while i < n:
        zeros, at = _get(words, at)
        if zeros < 0 or zeros > n - i:
            return False
        i += zeros
        count, at = _get(words, at)
        if count < 0 or count > n - i or zeros + count == 0:
            return False
        for _ in range(count):
            code, at = _get(words, at)
            if code < 0:
                return False
            previous += (code >> 1) ^ -(code & 1)
            pixels[i] = np.uint16(previous & 0xFFFF)
            i += 1
    return True
