"""The size that a JPEG or PNG claims, read before anything is decoded, as its decoder would find it."""

from __future__ import annotations

from slam.errors import DatabaseError

#: Pixels of the largest image that is decoded: eight cameras of four million pixels side by side.
MAX_PIXELS = 1 << 25
#: Of its longer side, which a JPEG can't exceed either.
MAX_SIDE = 65_535
_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8"
# Start-of-frame markers; the three that look like one (DHT, JPG, DAC) are something else.
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
#: Markers without a length (RST, TEM), and those that a decoder skips by theirs (DHT, DAC, DQT, DNL, DRI, APP, COM).
_BARE = frozenset((0x01, *range(0xD0, 0xD8)))
_SKIPPED = frozenset((0xC4, 0xCC, 0xDB, 0xDC, 0xDD, *range(0xE0, 0xF0), 0xFE))


def check_size(blob: bytes, kind: str) -> None:
    """Refuse what is no JPEG or PNG, or one that claims a size that no camera has.

    Raises:
        DatabaseError: with the size.
    """
    if not isinstance(blob, bytes):
        raise DatabaseError(f"{kind} image is no blob, but {str(blob)[:40]!r}")
    width, height = claimed_size(blob)
    if not width or not height:
        raise DatabaseError(f"{kind} image of {len(blob)} bytes is neither a JPEG nor a PNG that can be decoded")
    if width * height > MAX_PIXELS or max(width, height) > MAX_SIDE:
        raise DatabaseError(
            f"{kind} image claims {width}x{height} pixels, and {MAX_PIXELS} are the most: it is damaged"
        )


def claimed_size(blob: bytes) -> tuple[int, int]:
    """Width and height that the header claims; zeros when it is no JPEG or PNG, or is cut off before it says."""
    if blob.startswith(_PNG):
        # A PNG begins with the chunk that has the size; decoders refuse others.
        known = blob[12:16] == b"IHDR" and len(blob) >= 24
        return (int.from_bytes(blob[16:20], "big"), int.from_bytes(blob[20:24], "big")) if known else (0, 0)
    return _jpeg_size(blob) if blob.startswith(_JPEG) else (0, 0)


def _jpeg_size(blob: bytes) -> tuple[int, int]:
    at = 2
    while True:
        # Like the decoder: what is no marker before one is passed over, and so are fill bytes of 0xFF.
        at = blob.find(b"\xff", at)
        while 0 <= at < len(blob) and blob[at] == 0xFF:
            at += 1
        if at < 0 or at + 8 > len(blob):
            return 0, 0
        marker, length = blob[at], int.from_bytes(blob[at + 1 : at + 3], "big")
        if marker in _FRAMES:
            return int.from_bytes(blob[at + 6 : at + 8], "big"), int.from_bytes(blob[at + 4 : at + 6], "big")
        if marker in _SKIPPED:
            at += 1 + max(length, 2)
        elif marker in _BARE or marker == 0:
            at += 1
        else:
            # The image's data begin before any frame, or a marker that no decoder knows.
            return 0, 0
