"""Images as RTAB-Map stores them."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import pytest

from slam.database.depth_codec import encode_rvl
from slam.database.images import decode_color, decode_depth, encode_color, encode_depth
from slam.errors import DatabaseError


def test_jpeg_of_quality_95_is_near_and_png_is_exact() -> None:
    rows, columns = np.mgrid[0:48, 0:64]
    image = np.dstack([rows * 5, columns * 4, rows + columns]).astype(np.uint8)
    near = decode_color(encode_color(image, ".jpg"))
    assert np.abs(near.astype(int) - image).mean() < 2
    np.testing.assert_array_equal(decode_color(encode_color(image, ".png")), image)
    assert encode_color(image, ".jpg").startswith(b"\xff\xd8\xff")


def test_grey_images_are_read_as_colour() -> None:
    grey = np.full((8, 8), 77, dtype=np.uint8)
    blob = cv2.imencode(".png", grey)[1].tobytes()
    np.testing.assert_array_equal(decode_color(blob), np.full((8, 8, 3), 77))


@pytest.mark.parametrize("extension", [".rvl", ".png"])
def test_depth_is_kept_to_the_millimetre_and_the_rest_is_unknown(extension: str) -> None:
    depth_m = np.array([[0.0, 1.2344, 65.534, 65.535], [np.nan, np.inf, -1.0, 0.0004]], dtype=np.float32)
    expected = np.array([[0.0, 1.234, 65.534, 0.0], [0.0, 0.0, 0.0, 0.0]], dtype=np.float32)
    found = decode_depth(encode_depth(depth_m, extension))
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, expected)
    assert encode_depth(depth_m, extension) == encode_depth(found, extension)


@pytest.mark.parametrize("encode", [encode_rvl, lambda mm: cv2.imencode(".png", mm)[1].tobytes()])
def test_the_largest_value_of_foreign_files_is_unknown(encode: Callable[[np.ndarray], bytes]) -> None:
    depth_mm = np.array([[65_535, 65_534], [0, 1_500]], dtype=np.uint16)
    np.testing.assert_array_equal(decode_depth(encode(depth_mm)), np.array([[0, 65.534], [0, 1.5]], np.float32))


def test_float_png_is_read_as_metres() -> None:
    """Four bytes of a float as blue, green, red, alpha, as old files have it."""
    depth_m = np.array([[1.5, 0.0, np.nan], [np.inf, 2.25, -3.0]], dtype="<f4")
    blob = cv2.imencode(".png", depth_m.view(np.uint8).reshape(2, 3, 4))[1].tobytes()
    np.testing.assert_array_equal(decode_depth(blob), [[1.5, 0.0, 0.0], [0.0, 2.25, 0.0]])


def test_what_is_no_depth_is_refused() -> None:
    right = encode_color(np.zeros((8, 8, 3), dtype=np.uint8), ".jpg")
    with pytest.raises(DatabaseError, match="the right image of a stereo pair is no depth"):
        decode_depth(right)
    for blob in (b"", b"\x89PNG\r\n\x1a\n", right[:20]):
        with pytest.raises(DatabaseError, match="can be decoded"):
            decode_depth(blob)
        with pytest.raises(DatabaseError, match="can be decoded"):
            decode_color(blob)


def test_what_is_no_image_is_not_stored() -> None:
    with pytest.raises(DatabaseError, match=r"image of shape \(0, 3\) can't be stored as \.png"):
        encode_color(np.zeros((0, 3), dtype=np.uint8), ".png")
