"""Colour and depth images of a node, as RTAB-Map stores them."""

from __future__ import annotations

from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.database.image_size import check_size
from slam.errors import DatabaseError

JPEG_QUALITY = 95
#: First bytes of a depth image in RVL.
RVL_MAGIC = b"DEPTHRVL"
_MM_PER_M = np.float32(1000.0)
#: What sensors store, as they store 0, where nothing was measured.
_UNKNOWN_MM = np.iinfo(np.uint16).max


def encode_color(image_bgr: NDArray[np.uint8], extension: str) -> bytes:
    """Bytes of a colour image (H, W, 3) by ``Mem/ImageCompressionFormat`` (``.jpg`` or ``.png``)."""
    options = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY] if extension == ".jpg" else []
    return _encoded(extension, image_bgr, options)


def decode_color(blob: bytes) -> NDArray[np.uint8]:
    """Colour image (H, W, 3), blue green red, of a JPEG or PNG.

    Raises:
        DatabaseError: the bytes are no image.
    """
    return cast("NDArray[np.uint8]", _decoded(blob, cv2.IMREAD_COLOR, "colour"))


def encode_depth(depth_m: NDArray[np.float32], extension: str) -> bytes:
    """Bytes of a depth image (H, W) in metres, as 16-bit millimetres, by ``Mem/DepthCompressionFormat``.

    What is not finite, not positive or from 65.535 m on becomes 0, unknown.
    """
    with np.errstate(invalid="ignore"):
        mm = np.rint(depth_m * _MM_PER_M)
        known = (mm > 0) & (mm < _UNKNOWN_MM)
    depth_mm = np.where(known, mm, 0).astype(np.uint16)
    if extension != ".rvl":
        return _encoded(extension, depth_mm, [])
    # Compiled code: loaded by the first who needs it, not by everybody who opens a map.
    from slam.database.depth_codec import encode_rvl

    return encode_rvl(depth_mm)


def decode_depth(blob: bytes) -> NDArray[np.float32]:
    """Depth image (H, W) in metres, 0 where unknown, of RVL, a 16-bit PNG (millimetres) or a float PNG (metres).

    Raises:
        DatabaseError: the bytes are no depth image (the right image of a stereo pair, for example).
    """
    raw = _decoded_rvl(blob) if blob.startswith(RVL_MAGIC) else _decoded(blob, cv2.IMREAD_UNCHANGED, "depth")
    if raw.dtype == np.uint16 and raw.ndim == 2:
        return np.asarray(np.where(raw == _UNKNOWN_MM, np.uint16(0), raw).astype(np.float32) / _MM_PER_M)
    if raw.dtype == np.uint8 and raw.ndim == 3 and raw.shape[2] == 4:
        # OpenCV holds blue, green, red, alpha in memory: these four bytes are one little-endian float.
        metres = np.ascontiguousarray(raw).view("<f4")[..., 0]
        return np.where(np.isfinite(metres) & (metres > 0), metres, np.float32(0)).astype(np.float32)
    raise DatabaseError(
        f"depth image has {raw.dtype} pixels of shape {raw.shape}: it must be 16-bit millimetres or float metres "
        "(the right image of a stereo pair is no depth)"
    )


def _decoded_rvl(blob: bytes) -> NDArray[np.uint16]:
    from slam.database.depth_codec import decode_rvl

    return decode_rvl(blob)


def _encoded(extension: str, image: NDArray[np.integer], options: list[int]) -> bytes:
    try:
        done, blob = cv2.imencode(extension, image, options)
    except cv2.error as error:
        raise DatabaseError(f"image of shape {image.shape} can't be stored as {extension}: {error.err}") from error
    if not done:
        raise DatabaseError(f"image of shape {image.shape} can't be stored as {extension}")
    return blob.tobytes()


def _decoded(blob: bytes, flags: int, kind: str) -> NDArray[np.generic]:
    check_size(blob, kind)
    try:
        image = cv2.imdecode(np.frombuffer(blob, dtype=np.uint8), flags)
    except cv2.error as error:
        raise DatabaseError(f"{kind} image of {len(blob)} bytes can't be decoded: {error.err}") from error
    if image is None:
        raise DatabaseError(f"{kind} image of {len(blob)} bytes is neither a JPEG nor a PNG that can be decoded")
    return cast("NDArray[np.generic]", image)
