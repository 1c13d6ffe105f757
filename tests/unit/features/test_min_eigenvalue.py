"""The smaller eigenvalue: as OpenCV has it, the same bits every time, whatever memory it is written to."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.features.min_eigenvalue import LARGEST_BLOCK, min_eigenvalue
from tests.tours import dense

quickly = settings(max_examples=40, deadline=None)


def noise(seed: int, height: int, width: int) -> NDArray[np.uint8]:
    return np.random.default_rng(seed).integers(0, 256, (height, width), np.uint8)


def check(gray: NDArray[np.uint8], block: int) -> None:
    expected = cv2.cornerMinEigenVal(gray, block)
    found = min_eigenvalue(gray, block)
    assert found.dtype == np.float32
    # Of the trace: where the other eigenvalue is large, the smaller one is what rounding leaves of a difference.
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=2e-6 * max(float(np.max(expected)), 0.1))


@quickly
@given(st.integers(0, 10_000), st.integers(8, 40), st.integers(8, 40), st.integers(1, 7))
def test_as_opencv_has_it_up_to_the_border(seed: int, height: int, width: int, block: int) -> None:
    check(noise(seed, height, width), block)


@pytest.mark.parametrize("block", [3, 5])
def test_as_opencv_has_it_on_pictures(block: int) -> None:
    check(np.asarray(cv2.cvtColor(dense()[0].image_bgr, cv2.COLOR_BGR2GRAY), np.uint8), block)


def test_the_largest_block_does_not_overflow() -> None:
    stripes = np.where((np.indices((100, 100)).sum(axis=0) // 2) % 2, 255, 0).astype(np.uint8)
    check(stripes, LARGEST_BLOCK)


def test_memory_given_is_filled_and_tells_nothing_of_the_picture_before() -> None:
    first, second = noise(1, 30, 40), noise(2, 30, 40)
    memory = min_eigenvalue(first, 3)
    assert min_eigenvalue(second, 3, memory) is memory
    np.testing.assert_array_equal(memory, min_eigenvalue(second, 3))
    other = min_eigenvalue(noise(3, 20, 40), 3, memory)
    assert other.shape == (20, 40)


@pytest.mark.parametrize("shape", [(1, 9), (9, 1), (2, 2), (2, 9)])
def test_slivers_have_no_corners_that_fail(shape: tuple[int, int]) -> None:
    assert (min_eigenvalue(np.full(shape, 7, np.uint8), 3) == 0).all()
