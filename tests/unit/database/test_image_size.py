"""Sizes are read from the header, and absurd ones are refused before anything is decoded."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from slam.database.image_size import claimed_size
from slam.database.images import decode_color, decode_depth
from slam.errors import DatabaseError


@pytest.mark.parametrize("extension", [".jpg", ".png"])
@pytest.mark.parametrize("options", [[], [cv2.IMWRITE_JPEG_PROGRESSIVE, 1]])
def test_the_size_of_real_images(extension: str, options: list[int]) -> None:
    for shape in ((7, 5, 3), (48, 64), (300, 1000, 3)):
        image = np.zeros(shape, dtype=np.uint8)
        blob = cv2.imencode(extension, image, options if extension == ".jpg" else [])[1].tobytes()
        assert claimed_size(blob) == (shape[1], shape[0])


def test_what_says_no_size() -> None:
    whole = cv2.imencode(".jpg", np.zeros((8, 8, 3), dtype=np.uint8))[1].tobytes()
    for blob in (
        b"",
        b"\xff\xd8",
        b"\xff\xd8\xff\xff\xff\xff",
        b"text",
        whole[:30],
        b"\xff\xd8" + b"\xff\xe0\x00\x00" * 9,
    ):
        assert claimed_size(blob) == (0, 0)


def test_absurd_sizes_are_refused() -> None:
    png = bytearray(cv2.imencode(".png", np.zeros((8, 8), dtype=np.uint16))[1].tobytes())
    png[16:24] = (30000).to_bytes(4, "big") * 2
    jpeg = bytearray(cv2.imencode(".jpg", np.zeros((8, 8, 3), dtype=np.uint8))[1].tobytes())
    at = jpeg.index(b"\xff\xc0")
    jpeg[at + 5 : at + 9] = (30000).to_bytes(2, "big") * 2
    for blob in (bytes(png), bytes(jpeg)):
        with pytest.raises(DatabaseError, match="claims 30000x30000 pixels"):
            decode_color(blob)
        with pytest.raises(DatabaseError, match="claims 30000x30000 pixels"):
            decode_depth(blob)
