"""Words that two images share must fit one epipolar geometry, where that is asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.geometry import inverse, transform
from slam.loop.epipolar import epipolar_refusal
from slam.params import Params
from slam.types import Node
from tests.nodes import CAMERA, at, features, node, random_descriptors

PARAMS = Params().changed({"VhEp/Enabled": True})
RNG = np.random.default_rng(0)
POINTS = RNG.uniform([2.0, -1.0, -0.8], [6.0, 1.0, 0.8], (40, 3))


def seen_from(node_id: int, y: float, words: np.ndarray[tuple[int, ...], np.dtype[np.int32]]) -> Node:
    items = features(random_descriptors(len(words), node_id))
    pixels = CAMERA.project(transform(inverse(at(0.0, y) @ CAMERA.T_base_cam), POINTS[: len(words)]))
    return node(node_id, replace(items, pixels=pixels.astype(np.float32)), words)


def words(count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.int32]]:
    return np.arange(1, count + 1, dtype=np.int32)


def test_two_views_of_one_place_pass() -> None:
    assert epipolar_refusal(seen_from(2, 0.3, words(40)), seen_from(1, 0.0, words(40)), PARAMS) is None


def test_words_in_the_wrong_places_are_refused() -> None:
    new, old = seen_from(2, 0.3, words(40)), seen_from(1, 0.0, words(40))
    mixed = replace(new, features=replace(new.features, pixels=RNG.uniform(0, 240, (40, 2)).astype(np.float32)))
    refusal = epipolar_refusal(mixed, old, PARAMS.changed({"VhEp/MatchCountMin": 25}))
    assert refusal is not None
    assert refusal.test == "VhEp/MatchCountMin"
    assert refusal.value < 25 == refusal.threshold
    assert epipolar_refusal(new, old, PARAMS.changed({"VhEp/MatchCountMin": 25})) is None


def test_words_that_occur_twice_do_not_count() -> None:
    twice = np.repeat(words(5), 2)
    refusal = epipolar_refusal(seen_from(2, 0.3, twice), seen_from(1, 0.0, twice), PARAMS)
    assert refusal is not None
    assert (refusal.value, refusal.threshold) == (0.0, 8.0)


def test_unless_asked_nothing_is_refused() -> None:
    assert epipolar_refusal(seen_from(2, 0.3, words(2)), seen_from(1, 0.0, words(2)), Params()) is None
