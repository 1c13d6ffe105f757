"""Strict decoding."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.errors import SourceError
from slam.sensors.images import read_color, read_depth

DEPTH = np.arange(60 * 80, dtype=np.uint16).reshape(60, 80) * 13
COLOR = np.dstack([DEPTH % 251, DEPTH % 241, DEPTH % 239]).astype(np.uint8)


def encoded(kind: str, image: np.ndarray) -> bytes:
    return bytes(cv2.imencode(kind, image)[1])


def test_depth_comes_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "depth.png"
    path.write_bytes(encoded(".png", DEPTH))
    assert np.array_equal(read_depth(path), DEPTH)


def test_the_largest_depth_is_none(tmp_path: Path) -> None:
    path = tmp_path / "depth.png"
    path.write_bytes(encoded(".png", np.array([[65_535, 65_534, 0]], dtype=np.uint16)))
    assert read_depth(path).tolist() == [[0, 65_534, 0]]


def test_grey_images_become_colour(tmp_path: Path) -> None:
    path = tmp_path / "grey.png"
    path.write_bytes(encoded(".png", COLOR[..., 0]))
    assert np.array_equal(read_color(path), np.dstack([COLOR[..., 0]] * 3))


def test_padding_after_a_jpegs_end_is_allowed(tmp_path: Path) -> None:
    path = tmp_path / "padded.jpg"
    path.write_bytes(encoded(".jpg", COLOR) + bytes(300))
    assert read_color(path).shape == COLOR.shape


@given(data=st.data())
@pytest.mark.parametrize(("kind", "image"), [(".png", DEPTH), (".jpg", COLOR)])
def test_no_prefix_of_a_file_is_taken_for_the_file(
    kind: str, image: np.ndarray, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    whole = encoded(kind, image)
    path = tmp_path_factory.mktemp("cut") / f"image{kind}"
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole) - 1))])
    with pytest.raises(SourceError, match=path.name):
        (read_depth if kind == ".png" else read_color)(path)


@given(data=st.data())
def test_no_flipped_bit_of_a_png_goes_unseen(data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    whole = bytearray(encoded(".png", DEPTH))
    whole[data.draw(st.integers(0, len(whole) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    path = tmp_path_factory.mktemp("flipped") / "depth.png"
    path.write_bytes(whole)
    with pytest.raises(SourceError):
        read_depth(path)


def test_missing_and_foreign_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=r"absent\.png: can't be read \(No such file"):
        read_color(tmp_path / "absent.png")
    (tmp_path / "page.png").write_text("<html>not found</html>")
    with pytest.raises(SourceError, match=r"page\.png: 22 bytes that are neither PNG nor JPEG"):
        read_color(tmp_path / "page.png")


def test_colour_depth_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "depth.png"
    path.write_bytes(encoded(".png", np.dstack([DEPTH] * 3)))
    with pytest.raises(SourceError, match=r"3 channel\(s\) of 16 bits; depth is a PNG with one channel of 16 bits"):
        read_depth(path)


def test_a_jpeg_without_its_tables_is_refused(tmp_path: Path) -> None:
    whole = encoded(".jpg", COLOR)
    path = tmp_path / "headless.jpg"
    path.write_bytes(whole[:3] + whole[200:])
    with pytest.raises(SourceError, match="can't be decoded"):
        read_color(path)
