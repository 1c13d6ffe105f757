"""RVL to the byte: the words below were worked out on paper from the format's description."""

from __future__ import annotations

import numpy as np
import pytest

from slam.database.depth_codec import decode_rvl, encode_rvl
from slam.errors import DatabaseError

# 1 zero, 2 others: +5 (zig-zag 10: nibbles A 1), +2 (4); 2 zeros, 1 other: -1 (1).
IMAGE = np.array([[0, 5, 7], [0, 0, 6]], dtype=np.uint16)
GOLDEN = b"DEPTHRVL" + bytes([3, 0, 0, 0, 2, 0, 0, 0]) + (0x12A14211).to_bytes(4, "little")


def test_the_layout_is_the_format_s() -> None:
    assert encode_rvl(IMAGE) == GOLDEN
    np.testing.assert_array_equal(decode_rvl(GOLDEN), IMAGE)


def test_the_last_word_is_left_aligned() -> None:
    nothing = np.zeros((1, 1), dtype=np.uint16)
    assert encode_rvl(nothing)[16:] == (0x10000000).to_bytes(4, "little")
    # 0 zeros, 1 other: 65535 (zig-zag 131070 = 0o377776: nibbles E F F F F 3, low three bits first).
    farthest = np.full((1, 1), 65535, dtype=np.uint16)
    assert encode_rvl(farthest)[16:] == (0x01EFFFF3).to_bytes(4, "little")


def test_the_worst_image_fits() -> None:
    worst = np.zeros((64, 64), dtype=np.uint16)
    worst[::1, ::2] = np.where(np.arange(64 * 32).reshape(64, 32) % 2, 65535, 1)
    np.testing.assert_array_equal(decode_rvl(encode_rvl(worst)), worst)
    jumps = np.where(np.arange(64 * 64).reshape(64, 64) % 2, 65535, 1).astype(np.uint16)
    np.testing.assert_array_equal(decode_rvl(encode_rvl(jumps)), jumps)


@pytest.mark.parametrize(
    ("blob", "says"),
    [
        (b"", "no RVL image"),
        (b"DEPTHRVL", "no RVL image"),
        (b"\xff\xd8" + GOLDEN[2:], "no RVL image"),
        (GOLDEN[:8] + bytes(8) + GOLDEN[16:], "claims 0x0"),
        (GOLDEN[:8] + b"\xff" * 8 + GOLDEN[16:], "claims 4294967295x4294967295"),
        (GOLDEN[:16], "cut off or damaged"),
        (GOLDEN[:16] + b"\xff" * 64, "cut off or damaged"),
        (GOLDEN[:16] + bytes(64), "cut off or damaged"),
    ],
)
def test_damage_is_refused(blob: bytes, says: str) -> None:
    with pytest.raises(DatabaseError, match=says):
        decode_rvl(blob)
