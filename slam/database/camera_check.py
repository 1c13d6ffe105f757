"""What a stored calibration may say: cameras that exist."""

from __future__ import annotations

import math

from slam.camera import Camera
from slam.database.image_size import MAX_SIDE
from slam.errors import DatabaseError

#: Bytes of a calibration: a stereo pair with everything has less than a kilobyte.
_MOST_BYTES = 1 << 16
#: Focal lengths and centres in pixels; a telescope before a large sensor stays below.
_MOST_PIXELS = 1e7


def check_length(blob: bytes) -> None:
    """Refuse what is no calibration by its length alone; DatabaseError with it."""
    if not isinstance(blob, bytes) or len(blob) > _MOST_BYTES:
        raise DatabaseError(f"calibration has {len(blob)} bytes, and {_MOST_BYTES} are the most: it is damaged")


def checked_camera(camera: Camera) -> Camera:
    """The camera; its image may be 0x0 where the file does not say its size.

    Raises:
        DatabaseError: no camera is like that, with the number that says so.
    """
    for name, pixels in (("width", camera.width), ("height", camera.height)):
        if not 0 <= pixels <= MAX_SIDE:
            raise DatabaseError(f"calibration has an image {name} of {pixels}: 0 to {MAX_SIDE} pixels are possible")
    for name, focal in (("fx", camera.fx), ("fy", camera.fy)):
        if not 0 < focal < _MOST_PIXELS:
            raise DatabaseError(f"calibration has {name} = {focal:g}: a focal length is positive, in pixels")
    for name, centre in (("cx", camera.cx), ("cy", camera.cy)):
        if not (math.isfinite(centre) and abs(centre) < _MOST_PIXELS):
            raise DatabaseError(f"calibration has {name} = {centre:g}: the centre is a pixel")
    return camera
