"""The likelihood is TF-IDF to the letter, and what stands out among places stands out in it."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from slam.loop.likelihood import WordBag, adjust, raw_likelihood, similarity
from slam.params import Params
from tests.nodes import bag, features, node, random_descriptors

PARAMS = Params()
PLAIN = PARAMS.changed({"Kp/TfIdfLikelihoodUsed": False})
VIRTUAL_1 = PARAMS.changed({"Rtabmap/VirtualPlaceLikelihoodRatio": 1})
quickly = settings(max_examples=80, deadline=None)
seen = st.lists(st.integers(1, 12), max_size=15)
places = st.lists(st.tuples(seen, st.integers(0, 5)), max_size=8)
scores = hnp.arrays(np.float64, st.integers(0, 30), elements=st.one_of(st.just(0.0), st.floats(1e-3, 10)))


def bags(items: list[tuple[list[int], int]]) -> list[WordBag]:
    return [bag(words, rest) for words, rest in items]


@quickly
@given(seen, places, places)
def test_scores_equal_a_naive_tf_idf(
    new: list[int], known: list[tuple[list[int], int]], rest: list[tuple[list[int], int]]
) -> None:
    others = [(new, 0), *rest]
    everything = [words for words, _ in [*known, *others]]
    expected = []
    for words, unquantized in known:
        size = max(1, len(words) + unquantized)
        frequency = {w: Counter(words)[w] / size for w in set(new)}
        having = {w: sum(w in node_words for node_words in everything) for w in set(new)}
        expected.append(sum(frequency[w] * np.log10(len(everything) / having[w]) for w in set(new)))
    found = raw_likelihood(bag(new), bags(known), bags(others), PARAMS)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@quickly
@given(seen, places, st.randoms(use_true_random=False))
def test_the_order_of_places_does_not_matter(new: list[int], known: list[tuple[list[int], int]], rng: object) -> None:
    order = np.random.default_rng(hash(rng) % 1000).permutation(len(known))
    plain = raw_likelihood(bag(new), bags(known), [bag(new)], PARAMS)
    mixed = raw_likelihood(bag(new), [bags(known)[k] for k in order], [bag(new)], PARAMS)
    np.testing.assert_allclose(mixed, plain[order], atol=1e-12)


def test_a_word_that_every_node_has_says_nothing_and_a_rare_one_much() -> None:
    known = bags([([1, 2], 0), ([1, 3], 0), ([1, 4], 0)])
    common, rare = (raw_likelihood(bag([w]), known, [bag([1])], PARAMS) for w in (1, 3))
    assert common.tolist() == [0, 0, 0]
    assert rare.argmax() == 1
    assert rare[1] == pytest.approx(0.5 * np.log10(4))


def test_key_points_that_are_no_words_dilute_a_place() -> None:
    known = bags([([5], 0), ([5], 3), ([6], 0)])
    found = raw_likelihood(bag([5]), known, [], PARAMS)
    assert found[0] == pytest.approx(4 * found[1])


@quickly
@given(seen, seen)
def test_similarity_is_the_share_of_common_words(a: list[int], b: list[int]) -> None:
    common = sum((Counter(a) & Counter(b)).values())
    larger = max(len(a), len(b))
    assert similarity(bag(a), bag(b)) == similarity(bag(b), bag(a))
    assert similarity(bag(a), bag(b)) == pytest.approx(common / larger if larger else 0.0)
    assert similarity(bag(a), bag(a)) == (1.0 if a else 0.0)


def test_without_tf_idf_the_score_is_the_similarity() -> None:
    known = bags([([1, 2, 3, 4], 0), ([1, 2, 9, 9], 6), ([7], 0)])
    assert raw_likelihood(bag([1, 2, 3, 4]), known, [], PLAIN).tolist() == [1.0, 0.5, 0.0]


@quickly
@given(scores)
def test_only_scores_above_mean_and_deviation_count_more_than_one(raw: NDArray[np.float64]) -> None:
    likelihood, virtual = adjust(raw, PARAMS)
    positive = raw[raw > 0]
    assert len(likelihood) == len(raw)
    assert virtual >= 1
    if len(positive) < 2:
        assert (likelihood == 1).all()
        assert virtual == 2
        return
    mean, deviation = positive.mean(), positive.std(ddof=1)
    out = raw > mean + deviation
    assert (likelihood[~out] == 1).all()
    np.testing.assert_allclose(likelihood[out], (raw[out] - deviation + 1e-4) / mean)
    assume(deviation > 1e-9)
    assert virtual == pytest.approx(mean / deviation + 1)


@quickly
@given(scores, st.floats(0.01, 100))
def test_the_order_of_scores_is_kept(raw: NDArray[np.float64], scale: float) -> None:
    likelihood, _ = adjust(raw * scale, PARAMS)
    order = np.argsort(raw, kind="stable")
    assert (np.diff(likelihood[order]) >= -1e-9).all()


def test_the_other_virtual_place() -> None:
    raw = np.array([1.0, 1.0, 1.0, 5.0])
    _, virtual = adjust(raw, VIRTUAL_1)
    assert virtual == pytest.approx(raw.std(ddof=1) / (5.0 - raw.mean()) + 1)
    assert adjust(np.ones(4), VIRTUAL_1)[1] == 2.0
    assert adjust(np.ones(4), PARAMS)[1] == 2.0
    assert adjust(np.array([0.00361661, 0.00362887]), PARAMS)[1] == 2.0, "as good as equal, as in RTAB-Map"


def test_a_bag_counts_words_and_all_key_points() -> None:
    word_ids = np.array([3, 1, 3, -1, -2], np.int32)
    found = WordBag.of(node(1, features(random_descriptors(5, 0)), word_ids))
    assert found.words.tolist() == [1, 3]
    assert found.counts.tolist() == [1, 2]
    assert found.features == 5
