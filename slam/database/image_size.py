"""The size that a JPEG or PNG claims, read before anything is decoded."""

from __future__ import annotations

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8"
# Start-of-frame markers; the three that look like one (DHT, JPG, DAC) are something else.
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


def claimed_pixels(blob: bytes) -> int:
    """Width times height that the header claims; 0 when it is no JPEG or PNG, or is cut off before it says."""
    width, height = claimed_size(blob)
    return width * height


def claimed_size(blob: bytes) -> tuple[int, int]:
    """Width and height that the header claims; zeros when it is no JPEG or PNG, or is cut off before it says."""
    if blob.startswith(_PNG):
        return int.from_bytes(blob[16:20], "big"), int.from_bytes(blob[20:24], "big")
    return _jpeg_size(blob) if blob.startswith(_JPEG) else (0, 0)


def _jpeg_size(blob: bytes) -> tuple[int, int]:
    at = 2
    while at + 9 <= len(blob) and blob[at] == 0xFF:
        marker, length = blob[at + 1], int.from_bytes(blob[at + 2 : at + 4], "big")
        if marker in _FRAMES:
            return int.from_bytes(blob[at + 7 : at + 9], "big"), int.from_bytes(blob[at + 5 : at + 7], "big")
        # A marker may be preceded by fill bytes of 0xFF.
        at += 1 if marker == 0xFF else 2 + max(length, 2)
    return 0, 0
