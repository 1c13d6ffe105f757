"""Matching equals what a naive version says, and keeps its promises, for every set of descriptors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.features.hamming import distance, pack
from slam.features.match import MAX_DISTANCE, match_all, match_near
from tests.nodes import flipped, random_descriptors

Descriptors = NDArray[np.uint8]
quickly = settings(max_examples=60, deadline=None)
seeds = st.integers(0, 10_000)
ratios = st.sampled_from([0.5, 0.8, 0.95, 1.0])


def hamming(a: Descriptors, b: Descriptors) -> NDArray[np.int64]:
    """(N, M) differing bits, the obvious way."""
    return np.asarray(np.unpackbits(a[:, None] ^ b[None], axis=2).sum(axis=2), np.int64)


def look_alikes(seed: int, count_from: int, count_to: int) -> tuple[Descriptors, Descriptors]:
    """Two sets in which most have several relatives in the other, 0 to 100 bits away."""
    rng = np.random.default_rng(seed)
    parents = random_descriptors(4, seed)
    both = [
        flipped(parents[rng.integers(4)], rng.choice(256, rng.integers(0, 101), replace=False).tolist())
        for _ in range(count_from + count_to)
    ]
    stacked = np.array(both, np.uint8).reshape(-1, 32)
    return stacked[:count_from], stacked[count_from:]


def naive(distances: NDArray[np.int64], allowed: NDArray[np.bool_], ratio: float, *, mutual: bool) -> list[list[int]]:
    """Matches by the rule in words: nearest, near enough, clearly nearer than the second, each side at most once."""
    wanted: dict[int, int] = {}
    for i, (row, ok) in enumerate(zip(distances, allowed, strict=True)):
        order = [int(j) for j in np.argsort(row, kind="stable") if ok[j]]
        if not order or row[order[0]] > MAX_DISTANCE:
            continue
        if len(order) > 1 and row[order[0]] > ratio * row[order[1]]:
            continue
        wanted[i] = order[0]
    found = []
    for i, j in sorted(wanted.items()):
        rivals = range(len(distances)) if mutual else [k for k, other in wanted.items() if other == j]
        if min(rivals, key=lambda k: (distances[k, j], k)) == i:
            found.append([i, j])
    return found


@quickly
@given(seeds, st.sampled_from([8, 16, 32, 64]))
def test_distance_counts_differing_bits(seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.integers(0, 256, (2, size)).astype(np.uint8)
    assert distance(pack(a[None])[0], pack(b[None])[0]) == np.unpackbits(a ^ b).sum()
    assert distance(pack(a[None])[0], pack(a[None])[0]) == 0


@quickly
@given(seeds, st.integers(0, 30), st.integers(0, 30), ratios)
def test_matching_all_equals_the_naive_version(seed: int, count_from: int, count_to: int, ratio: float) -> None:
    a, b = look_alikes(seed, count_from, count_to)
    found = match_all(a, b, ratio=ratio)
    everywhere = np.ones((count_from, count_to), np.bool_)
    expected = naive(hamming(a, b), everywhere, ratio, mutual=True) if count_to > 1 else []
    assert found.tolist() == expected


@quickly
@given(seeds, st.integers(0, 30), st.integers(0, 30), ratios, st.floats(1.0, 60.0))
def test_guided_matching_equals_the_naive_version(
    seed: int, count_from: int, count_to: int, ratio: float, radius: float
) -> None:
    a, b = look_alikes(seed, count_from, count_to)
    rng = np.random.default_rng(seed)
    predicted = rng.uniform(-40, 140, (count_from, 2)).astype(np.float32)
    predicted[rng.random(count_from) < 0.2] = np.nan
    pixels = rng.uniform(0, 100, (count_to, 2)).astype(np.float32)
    found = match_near(predicted, a, pixels, b, radius=radius, ratio=ratio)
    apart = np.linalg.norm(predicted[:, None].astype(float) - pixels[None].astype(float), axis=2)
    np.testing.assert_array_equal(
        found, np.reshape(naive(hamming(a, b), apart <= radius, ratio, mutual=False), (-1, 2))
    )


@quickly
@given(seeds, st.integers(1, 40), st.integers(2, 40))
def test_no_key_point_is_matched_twice(seed: int, count_from: int, count_to: int) -> None:
    a, b = look_alikes(seed, count_from, count_to)
    zero = np.zeros((count_from, 2), np.float32)
    near = match_near(zero, a, np.zeros((count_to, 2), np.float32), b, radius=5.0, ratio=1.0)
    for found in (near, match_all(a, b, ratio=1.0)):
        assert len(set(found[:, 0].tolist())) == len(set(found[:, 1].tolist())) == len(found)


@quickly
@given(seeds, st.integers(1, 25))
def test_shuffled_key_points_are_found_again(seed: int, count: int) -> None:
    a = random_descriptors(count + 1, seed)
    order = np.random.default_rng(seed).permutation(count + 1)
    found = match_all(a, a[order], ratio=0.8)
    assert [order[j] for _, j in found.tolist()] == list(range(count + 1))


@pytest.mark.parametrize(("offset", "within"), [(9.9, True), (10.0, True), (10.1, False)])
@pytest.mark.parametrize("direction", [(1, 0), (-1, 0), (0, 1), (0, -1), (0.6, -0.8)])
def test_the_guided_search_reaches_as_far_as_the_radius(
    offset: float, within: bool, direction: tuple[float, float]
) -> None:
    descriptor = random_descriptors(1, 0)
    predicted = np.array([[50.0, 50.0]], np.float32)
    pixel = (predicted + offset * np.array(direction)).astype(np.float32)
    found = match_near(predicted, descriptor, pixel, descriptor, radius=10.0, ratio=0.8)
    assert len(found) == within


def test_a_rival_outside_the_window_does_not_make_a_match_ambiguous() -> None:
    descriptor = random_descriptors(1, 0)
    twins = np.concatenate([descriptor, descriptor])
    pixels = np.array([[50.0, 50.0], [90.0, 50.0]], np.float32)
    there = np.array([[49.0, 50.0]], np.float32)
    query = flipped(descriptor[0], [3, 77])[None]
    assert match_near(there, query, pixels, twins, radius=10.0, ratio=0.8).tolist() == [[0, 0]]
    assert len(match_near(there, query, pixels, twins, radius=60.0, ratio=0.8)) == 0
    assert len(match_all(query, twins, ratio=0.8)) == 0


@pytest.mark.parametrize(("bits", "matched"), [(15, True), (16, True), (17, False)])
def test_the_nearest_must_be_nearer_by_the_ratio(bits: int, matched: bool) -> None:
    query = random_descriptors(1, 2)
    two = np.array([flipped(query[0], range(bits)), flipped(query[0], range(100, 120))])  # 20 away: up to 0.8 x 20
    assert len(match_all(query, two, ratio=0.8)) == matched
    spot = np.zeros((1, 2), np.float32)
    assert len(match_near(spot, query, np.zeros((2, 2), np.float32), two, radius=1.0, ratio=0.8)) == matched


@pytest.mark.parametrize(("bits", "matched"), [(MAX_DISTANCE, True), (MAX_DISTANCE + 1, False)])
def test_descriptors_too_different_never_match(bits: int, matched: bool) -> None:
    first, other = random_descriptors(2, 1)
    query = flipped(first, range(bits))[None]
    two = np.array([first, ~first if bits else other])
    assert len(match_all(query, two, ratio=0.9)) == matched
    spot = np.zeros((1, 2), np.float32)
    assert len(match_near(spot, query, np.zeros((2, 2), np.float32), two, radius=1.0, ratio=0.9)) == matched
