"""Images encoded in advance: the same bytes, for the images that were meant, and errors in their turn."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from slam.database.encoder import ImageEncoder
from slam.database.images import encode_color, encode_depth
from slam.errors import DatabaseError
from slam.params import Params
from tests.tours import dense

PARAMS = Params()
COLOR, DEPTH = PARAMS.Mem.ImageCompressionFormat, PARAMS.Mem.DepthCompressionFormat


@pytest.fixture
def encoder() -> Iterator[ImageEncoder]:
    one = ImageEncoder()
    yield one
    one.close()


@pytest.mark.parametrize("begun", [True, False])
def test_begun_or_not_the_bytes_are_the_same(encoder: ImageEncoder, begun: bool) -> None:
    for frame in dense()[:3]:
        if begun:
            encoder.begin(frame.image_bgr, frame.depth_m, PARAMS)
        assert encoder.color(frame.image_bgr, COLOR) == encode_color(frame.image_bgr, COLOR)
        assert encoder.depth(frame.depth_m, DEPTH) == encode_depth(frame.depth_m, DEPTH)


def test_another_image_is_not_taken_for_the_one_that_was_begun(encoder: ImageEncoder) -> None:
    first, second = dense()[0], dense()[5]
    encoder.begin(first.image_bgr, first.depth_m, PARAMS)
    assert encoder.color(second.image_bgr, COLOR) == encode_color(second.image_bgr, COLOR)
    assert encoder.depth(second.depth_m, DEPTH) == encode_depth(second.depth_m, DEPTH)


def test_a_format_that_changed_meanwhile_counts(encoder: ImageEncoder) -> None:
    frame = dense()[0]
    encoder.begin(frame.image_bgr, frame.depth_m, PARAMS)
    assert COLOR != ".png"
    assert encoder.color(frame.image_bgr, ".png") == encode_color(frame.image_bgr, ".png")
    assert encoder.depth(frame.depth_m, ".png") == encode_depth(frame.depth_m, ".png")


def test_what_cannot_be_encoded_is_refused_where_it_is_asked_for(encoder: ImageEncoder) -> None:
    frame = dense()[0]
    empty = np.zeros((0, 0, 3), np.uint8)
    encoder.begin(empty, frame.depth_m, PARAMS)
    assert encoder.depth(frame.depth_m, DEPTH) == encode_depth(frame.depth_m, DEPTH)
    with pytest.raises(DatabaseError, match="can't be stored"):
        encoder.color(empty, COLOR)
