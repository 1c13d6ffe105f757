"""Words of float descriptors: the forest agrees with looking at all words, and lets go of what is let go."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.errors import ParameterError
from slam.features.dictionary import Dictionary
from slam.features.float_index import FloatIndex
from slam.features.match import MAX_SHARE, match_all, match_near
from slam.params import Params
from tests.nodes import random_descriptors

PARAMS = Params()
APART = PARAMS.changed({"Kp/NewWordsComparedTogether": False})
quickly = settings(max_examples=25, deadline=None)
seeds = st.integers(0, 10_000)
Floats = NDArray[np.float32]


def float_descriptors(count: int, seed: int, *, width: int = 64, parents: int = 8, spread: float = 0.3) -> Floats:
    """Unit vectors around a few parents, so that there are near and far ones."""
    rng = np.random.default_rng(seed)
    centres = np.random.default_rng(1).normal(size=(parents, width))
    drawn = centres[rng.integers(parents, size=count)] + rng.uniform(0, 2 * spread, (count, 1)) * rng.normal(
        size=(count, width)
    )
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True), np.float32)


def squared(a: Floats, b: Floats) -> NDArray[np.float64]:
    """(N, M) squared distances, the obvious way."""
    return np.asarray(((a[:, None].astype(np.float64) - b[None].astype(np.float64)) ** 2).sum(axis=2))


@quickly
@given(seeds, st.integers(2, 300), st.sampled_from([0.5, 0.8, 1.0]))
def test_among_few_words_the_answer_is_that_of_looking_at_all(seed: int, count: int, ratio: float) -> None:
    words, queries = float_descriptors(count, seed), float_descriptors(30, seed + 1)
    index = FloatIndex(64, seed=seed)
    index.append(words)
    rows = index.assign(queries, ratio, learn=False, together=False)
    distances = squared(queries, words)
    for row, d in zip(rows.tolist(), distances, strict=True):
        best, second = np.sort(d)[:2]
        if abs(best - ratio * second) > 1e-5:
            assert (row >= 0) == (best <= ratio * second)
        if row >= 0:
            assert d[row] == pytest.approx(best, abs=1e-5)


def test_among_many_words_nearly_all_nearest_are_found() -> None:
    words = float_descriptors(20_000, 0, parents=600)
    queries = float_descriptors(300, 5, parents=600)
    index = FloatIndex(64, seed=0)
    index.append(words)
    rows = index.assign(queries, np.inf, learn=False, together=False)
    nearest = (2.0 - 2.0 * queries @ words.T).argmin(axis=1)
    assert np.mean(rows == nearest) > 0.9


def test_a_lone_word_is_never_known_but_is_the_nearest() -> None:
    word = float_descriptors(1, 0)
    index = FloatIndex(64, seed=0)
    index.append(word)
    assert index.assign(word, 1.0, learn=False, together=False).tolist() == [-1]
    assert index.assign(word, np.inf, learn=False, together=False).tolist() == [0]


def test_an_empty_index_knows_nothing() -> None:
    assert (
        FloatIndex(64, seed=0).assign(float_descriptors(3, 0), np.inf, learn=False, together=False).tolist() == [-1] * 3
    )


@quickly
@given(seeds)
def test_words_let_go_are_not_found_before_and_after_compacting(seed: int) -> None:
    words = float_descriptors(200, seed)
    index = FloatIndex(64, seed=seed)
    index.append(words)
    index.alive[:200:2] = False
    before = index.assign(words, np.inf, learn=False, together=False)
    assert (before % 2 == 1).all()
    assert before[1::2].tolist() == list(range(1, 200, 2))
    kept = index.compact()
    assert kept.tolist() == list(range(1, 200, 2))
    np.testing.assert_array_equal(index.unpacked(slice(0, index.count)), words[1::2])
    assert index.assign(words[1::2], np.inf, learn=False, together=False).tolist() == list(range(100))


def test_many_equal_words_and_growth_are_no_trouble() -> None:
    index = FloatIndex(64, seed=0)
    twins = np.repeat(float_descriptors(1, 0), 100, axis=0)
    index.append(twins)
    others = float_descriptors(3000, 1)
    index.append(others)
    assert index.assign(twins[:1], np.inf, learn=False, together=False)[0] < 100
    assert np.mean(index.assign(others, np.inf, learn=False, together=False) == np.arange(100, 3100)) > 0.99


@quickly
@given(seeds, st.integers(3, 200))
def test_an_old_float_descriptor_is_a_known_word(seed: int, count: int) -> None:
    dictionary = Dictionary(seed=seed)
    descriptors = float_descriptors(count, seed)
    ids, new_ids, new_descriptors = dictionary.quantize(descriptors, APART)
    dictionary.use(ids.tolist())
    assert len(new_ids) == count
    np.testing.assert_array_equal(new_descriptors, descriptors)
    again, made, _ = dictionary.quantize(descriptors[::-1], PARAMS)
    assert again.tolist() == ids[::-1].tolist()
    assert len(made) == 0
    np.testing.assert_array_equal(dictionary.descriptors(ids), descriptors)
    dictionary.release(ids.tolist())
    assert len(dictionary) == 0


def test_words_made_for_a_node_that_is_not_kept_go_again() -> None:
    dictionary = Dictionary(seed=0)
    ids, _, _ = dictionary.quantize(float_descriptors(10, 0), APART)
    dictionary.discard(ids.tolist())
    assert len(dictionary) == 0


def test_descriptors_of_another_kind_are_refused() -> None:
    dictionary = Dictionary(seed=0)
    dictionary.quantize(random_descriptors(3, 0), PARAMS)
    for other in (float_descriptors(2, 0), np.zeros((2, 64), np.uint8)):
        with pytest.raises(ParameterError, match=r"can't be compared .* of 32 uint8: set .*Kp/DetectorStrategy"):
            dictionary.quantize(other, PARAMS)
        with pytest.raises(ParameterError, match="can't be compared"):
            match_all(random_descriptors(3, 0), other, ratio=0.8)


def test_the_same_seed_gives_the_same_words() -> None:
    runs = []
    for _ in range(2):
        dictionary = Dictionary(seed=3)
        runs.append([dictionary.quantize(float_descriptors(400, k), PARAMS)[0].tolist() for k in range(4)])
    assert runs[0] == runs[1]


@quickly
@given(seeds, st.integers(1, 25), st.integers(2, 25), st.sampled_from([0.5, 0.8, 1.0]))
def test_float_matches_are_mutual_near_and_clear(seed: int, count_from: int, count_to: int, ratio: float) -> None:
    a, b = float_descriptors(count_from, seed, parents=3), float_descriptors(count_to, seed + 1, parents=3)
    distances = squared(a, b)
    expected = []
    for i, row in enumerate(distances):
        j = int(row.argmin())
        best, second = np.sort(row)[:2]
        if best <= min(2 * MAX_SHARE, ratio * second) and distances[:, j].argmin() == i:
            expected.append([i, j])
    assert match_all(a, b, ratio=ratio).tolist() == expected


def test_float_matches_near_a_prediction_look_only_there() -> None:
    descriptors = np.eye(20, 64, dtype=np.float32)
    pixels = np.column_stack([np.arange(20) * 15.0, np.full(20, 7.0)]).astype(np.float32)
    found = match_near(pixels + 3, descriptors, pixels, descriptors, radius=10.0, ratio=0.8)
    assert found.tolist() == [[i, i] for i in range(20)]
    swapped = match_near(pixels + 3, descriptors[::-1].copy(), pixels, descriptors, radius=5.0, ratio=0.8)
    assert len(swapped) == 0


def test_scale_of_float_descriptors_does_not_matter() -> None:
    a, b = float_descriptors(40, 0, parents=30), float_descriptors(40, 1, parents=30)
    assert match_all(a, b, ratio=0.8).tolist() == match_all(512 * a, 512 * b, ratio=0.8).tolist() != []
