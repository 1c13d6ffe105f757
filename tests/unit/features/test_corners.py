"""Corners: peaks only, never too close to each other, and placed to a fraction of a pixel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.features import corners

quickly = settings(max_examples=40, deadline=None)
seeds = st.integers(0, 10_000)


def strengths(seed: int, shape: tuple[int, int] = (31, 45), levels: int = 4) -> NDArray[np.float32]:
    """A map with few levels, so that plateaus are common."""
    return np.random.default_rng(seed).integers(0, levels, shape).astype(np.float32)


@quickly
@given(seeds, st.integers(1, 5), st.floats(-0.5, 3.5))
def test_a_maximum_is_at_least_as_strong_as_all_around_it(seed: int, border: int, threshold: float) -> None:
    strength = strengths(seed)
    pixels, found = corners.local_maxima(strength, threshold, border)
    for (x, y), value in zip(pixels.tolist(), found.tolist(), strict=True):
        assert border <= x < 45 - border and border <= y < 31 - border
        assert value == strength[y, x] > threshold
        assert value == strength[y - 1 : y + 2, x - 1 : x + 2].max()


@quickly
@given(seeds)
def test_maxima_never_touch_each_other(seed: int) -> None:
    pixels, _ = corners.local_maxima(strengths(seed, levels=2), 0.0, 1)
    apart = np.abs(pixels[:, None] - pixels[None]).max(axis=2) + 9 * np.eye(len(pixels), dtype=int)
    assert len(pixels) == 0 or apart.min() > 1


@quickly
@given(seeds)
def test_every_strict_peak_is_found(seed: int) -> None:
    strength = np.random.default_rng(seed).permutation(31 * 45).reshape(31, 45).astype(np.float32)
    inner = strength[1:-1, 1:-1]
    around = [np.roll(strength, (dy, dx), (0, 1))[1:-1, 1:-1] for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx]
    y, x = np.nonzero(inner > np.max(around, axis=0))
    pixels, _ = corners.local_maxima(strength, -1.0, 1)
    assert pixels.tolist() == np.column_stack([x + 1, y + 1]).tolist()


@pytest.mark.parametrize("step", [(0, 1), (1, 0), (1, 1), (1, -1)])
def test_of_two_equal_neighbours_one_is_the_peak(step: tuple[int, int]) -> None:
    strength = np.zeros((9, 9), np.float32)
    strength[4, 4] = strength[4 + step[0], 4 + step[1]] = 2.0
    assert len(corners.local_maxima(strength, 0.0, 1)[0]) == 1


def test_a_peak_must_be_above_the_threshold() -> None:
    strength = np.zeros((9, 9), np.float32)
    strength[4, 4] = 2.0
    assert [len(corners.local_maxima(strength, t, 1)[0]) for t in (1.9, 2.0)] == [1, 0]


def test_a_flat_image_has_no_corner() -> None:
    assert len(corners.local_maxima(np.zeros((50, 50), np.float32), 0.0, 3)[0]) == 0


@quickly
@given(
    st.lists(st.tuples(st.integers(0, 99), st.integers(0, 79)), max_size=120, unique=True),
    st.one_of(st.floats(1.0, 50.0), st.integers(1, 50).map(float)),
    st.integers(1, 60),
)
def test_spread_is_the_greedy_choice(points: list[tuple[int, int]], least: float, limit: int) -> None:
    pixels = np.array(points, np.int32).reshape(-1, 2)
    expected: list[int] = []
    for row, point in enumerate(pixels):
        if len(expected) < limit and all(np.sum((pixels[k] - point) ** 2) >= least**2 for k in expected):
            expected.append(row)
    rows = corners.spread(pixels, np.arange(len(pixels)), (80, 100), least, limit)
    assert rows.tolist() == expected


def test_three_far_corners_of_one_cell_all_keep_others_away() -> None:
    # With 40 px cells, three points of one cell can be 40 px from each other; each must repel the fourth.
    triangle = [(0, 0), (39, 10), (10, 39)]
    for near in [(2, 1), (41, 10), (10, 41)]:
        pixels = np.array([*triangle, near], np.int32)
        assert corners.spread(pixels, np.arange(4), (100, 100), 40.0, 10).tolist() == [0, 1, 2]


def test_the_strongest_come_first() -> None:
    pixels = np.array([[10, 10], [12, 10], [50, 50]], np.int32)
    assert corners.spread(pixels, np.array([1, 0, 2]), (60, 60), 5.0, 10).tolist() == [1, 2]


@pytest.mark.parametrize("x", [20.0, 20.2, 20.49, 19.7, 19.55])
@pytest.mark.parametrize("y", [15.0, 14.6, 15.35])
def test_blobs_are_found_to_a_twentieth_of_a_pixel(x: float, y: float) -> None:
    rows, cols = np.mgrid[0:31, 0:41]
    blob = np.exp(-((cols - x) ** 2 + (rows - y) ** 2) / (2 * 3.0**2)).astype(np.float32)
    pixels, _ = corners.local_maxima(blob, 0.5, 2)
    assert len(pixels) == 1
    np.testing.assert_allclose(corners.refine(blob, pixels), [[x, y]], atol=0.05)


@quickly
@given(seeds)
def test_refinement_stays_within_half_a_pixel(seed: int) -> None:
    strength = strengths(seed)
    pixels, _ = corners.local_maxima(strength, 0.0, 1)
    assert (np.abs(corners.refine(strength, pixels) - pixels) <= 0.5).all()
