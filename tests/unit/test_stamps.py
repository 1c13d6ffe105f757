"""Nearest stamps, one to one."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.stamps import pair_nearest

stamps = st.lists(st.integers(0, 400), unique=True, max_size=40).map(lambda ms: np.array(sorted(ms)) / 1000.0)


@given(stamps, stamps, st.sampled_from([0.0, 0.005, 0.02, 0.1]))
def test_pairs_are_one_to_one_within_the_limit_and_none_is_left(a: np.ndarray, b: np.ndarray, within: float) -> None:
    pairs = pair_nearest(a, b, within)
    assert len(set(pairs[:, 0].tolist())) == len(set(pairs[:, 1].tolist())) == len(pairs)
    assert np.all(np.diff(pairs[:, 0]) > 0)
    assert np.all(np.abs(a[pairs[:, 0]] - b[pairs[:, 1]]) <= within + 1e-9)
    free_a, free_b = np.delete(a, pairs[:, 0]), np.delete(b, pairs[:, 1])
    assert not np.any(np.abs(free_a[:, None] - free_b[None]) <= within - 1e-9)


@given(stamps)
def test_a_recording_pairs_with_itself(a: np.ndarray) -> None:
    assert np.array_equal(pair_nearest(a, a, 0.02), np.column_stack([np.arange(len(a))] * 2))


@given(stamps, stamps)
def test_the_closest_pair_of_all_is_made(a: np.ndarray, b: np.ndarray) -> None:
    pairs = pair_nearest(a, b, 0.1)
    distances = np.abs(a[:, None] - b[None])
    if distances.size and distances.min() < 0.0999:
        assert np.isclose(np.abs(a[pairs[:, 0]] - b[pairs[:, 1]]).min(), distances.min())


def test_the_nearest_wins_and_the_other_takes_the_next() -> None:
    pairs = pair_nearest(np.array([1.000, 1.010]), np.array([0.985, 1.008]), 0.02)
    assert pairs.tolist() == [[0, 0], [1, 1]]


def test_nothing_pairs_with_nothing() -> None:
    assert pair_nearest(np.empty(0), np.array([1.0]), 1.0).shape == (0, 2)
    assert pair_nearest(np.array([1.0]), np.empty(0), 1.0).shape == (0, 2)
