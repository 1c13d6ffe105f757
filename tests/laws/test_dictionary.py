"""The dictionary gives old looks their old words, lets go of words without users, and never reuses a number."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from numpy.typing import NDArray

from slam.features.dictionary import Dictionary
from slam.features.hamming import pack
from slam.features.word_index import HORIZON, WordIndex
from slam.params import Params
from tests.nodes import flipped, random_descriptors

PARAMS = Params()
APART = PARAMS.changed({"Kp/NewWordsComparedTogether": False})
quickly = settings(max_examples=20, deadline=None)
seeds = st.integers(0, 10_000)


def filled(count: int, seed: int = 0) -> tuple[Dictionary, NDArray[np.uint8], NDArray[np.int32]]:
    """A dictionary of random words that one node uses, with their descriptors and ids."""
    dictionary = Dictionary(seed=seed)
    descriptors = random_descriptors(count, seed)
    ids, _, _ = dictionary.quantize(descriptors, PARAMS)
    dictionary.use(ids.tolist())
    return dictionary, descriptors, ids


@quickly
@given(seeds, st.integers(1, 200))
def test_an_old_descriptor_is_a_known_word(seed: int, count: int) -> None:
    dictionary, descriptors, ids = filled(count, seed)
    again, new_ids, new_descriptors = dictionary.quantize(descriptors[::-1], PARAMS)
    assert again.tolist() == ids[::-1].tolist()
    assert len(new_ids) == len(new_descriptors) == 0
    np.testing.assert_array_equal(dictionary.descriptors(ids), descriptors)


def test_words_made_are_handed_out_with_their_descriptors() -> None:
    dictionary, old, _ = filled(5)
    fresh = random_descriptors(3, 99)
    ids, new_ids, new_descriptors = dictionary.quantize(np.concatenate([old[:2], fresh, fresh]), PARAMS)
    assert ids.tolist() == [1, 2, 6, 7, 8, 6, 7, 8]
    assert new_ids.tolist() == [6, 7, 8]
    np.testing.assert_array_equal(new_descriptors, fresh)
    assert dictionary.ids() == list(range(1, 9))
    assert len(dictionary) == 8


def test_almost_all_slightly_different_looks_are_known() -> None:
    dictionary, descriptors, ids = filled(500)
    rng = np.random.default_rng(1)
    for bits, least in ((4, 0.999), (12, 0.99), (24, 0.85)):
        looks = np.array([flipped(d, rng.choice(256, bits, replace=False).tolist()) for d in descriptors])
        packed = pack(looks)
        index: WordIndex = dictionary._index
        rows = index.assign(packed, 0.8, learn=False, together=False)
        assert np.mean(rows == ids - 1) >= least


@pytest.mark.parametrize(("bits", "known"), [(20, True), (50, True), (52, False), (70, False)])
def test_a_lone_word_takes_what_is_clearly_within_the_horizon(bits: int, known: bool) -> None:
    # The second nearest counts as HORIZON away: 0.8 x 64 = 51.2. Flipped bits lie outside most hash keys' bits.
    dictionary = Dictionary(seed=0)
    word = random_descriptors(1, 0)
    dictionary.quantize(word, PARAMS)
    used = set(dictionary._index._bits[0].tolist())
    free = [b for b in range(256) if b not in used]
    ids, new_ids, _ = dictionary.quantize(flipped(word[0], free[:bits])[None], PARAMS)
    assert (len(new_ids) == 0) == known
    assert ids.tolist() == [1 if known else 2]
    assert HORIZON == 64


@pytest.mark.parametrize("seed", [0, 1, 2, 4])
@pytest.mark.parametrize(("nearest", "known"), [(15, True), (16, True), (17, False), (20, False)])
def test_a_look_between_two_words_becomes_its_own(nearest: int, known: bool, seed: int) -> None:
    # The seed decides which of both words the tables come upon first; with 3 they miss one of them.
    first = random_descriptors(1, 3)[0]
    bits = np.random.default_rng(3).permutation(256).tolist()
    look = flipped(first, bits[:nearest])
    second = flipped(look, bits[100:120])  # 20 away: known up to 0.8 x 20
    dictionary = Dictionary(seed=seed)
    dictionary.quantize(np.array([first, second]), PARAMS.changed({"Kp/NndrRatio": 0.0}))
    ids, new_ids, _ = dictionary.quantize(look[None], PARAMS)
    assert ids.tolist() == [1 if known else 3]
    assert (len(new_ids) == 0) == known


def test_twins_of_one_image_are_one_word_only_if_compared_together() -> None:
    twins = np.repeat(random_descriptors(1, 0), 2, axis=0)
    assert Dictionary(seed=0).quantize(twins, PARAMS)[0].tolist() == [1, 1]
    assert Dictionary(seed=0).quantize(twins, APART)[0].tolist() == [1, 2]


def test_words_without_users_are_let_go_and_their_numbers_never_return() -> None:
    dictionary, descriptors, ids = filled(10)
    dictionary.use(ids[:4].tolist())
    dictionary.release(ids.tolist())
    assert dictionary.ids() == [1, 2, 3, 4]
    again, new_ids, _ = dictionary.quantize(descriptors, PARAMS)
    assert again.tolist() == [1, 2, 3, 4, *range(11, 17)]
    assert new_ids.tolist() == list(range(11, 17))


def test_restoring_brings_words_back_under_their_numbers() -> None:
    dictionary, descriptors, ids = filled(10)
    dictionary.release(ids[3:].tolist())
    assert dictionary.restore(ids, descriptors, PARAMS) == {i: i for i in range(1, 11)}
    assert dictionary.ids() == list(range(1, 11))
    np.testing.assert_array_equal(dictionary.descriptors(ids), descriptors)
    assert dictionary.quantize(descriptors, PARAMS)[0].tolist() == ids.tolist()


def test_a_restored_word_that_has_a_double_by_now_becomes_that_one() -> None:
    dictionary, descriptors, ids = filled(3)
    dictionary.release(ids.tolist())
    looks = np.array([flipped(d, [7, 99]) for d in descriptors[:2]])
    dictionary.quantize(looks, PARAMS)
    assert dictionary.restore(ids, descriptors, PARAMS) == {1: 4, 2: 5, 3: 3}
    assert dictionary.ids() == [3, 4, 5]


def test_words_restored_from_a_file_leave_their_numbers_taken() -> None:
    dictionary = Dictionary(seed=0)
    dictionary.restore(np.array([40, 7], np.int32), random_descriptors(2, 0), PARAMS)
    assert dictionary.quantize(random_descriptors(1, 1), PARAMS)[1].tolist() == [41]


def test_compaction_changes_nothing_that_is_visible() -> None:
    dictionary, descriptors, ids = filled(5000)
    dictionary.use(ids[::3].tolist())
    dictionary.release(ids.tolist())
    kept = ids[::3]
    assert dictionary._index.count < 2000, "5000 rows of which 1667 are in use: the others should be gone"
    assert dictionary.ids() == kept.tolist()
    np.testing.assert_array_equal(dictionary.descriptors(kept), descriptors[::3])
    again, new_ids, _ = dictionary.quantize(descriptors[:30], PARAMS)
    assert again[::3].tolist() == kept[:10].tolist()
    assert new_ids.tolist() == list(range(5001, 5021))


@quickly
@given(seeds)
def test_a_compacted_index_answers_as_before(seed: int) -> None:
    rng = np.random.default_rng(seed)
    parents = random_descriptors(20, seed)
    looks = np.array([flipped(parents[rng.integers(20)], rng.integers(0, 256, 20).tolist()) for _ in range(300)])
    indices = [WordIndex(4, seed=seed) for _ in range(2)]
    for index in indices:
        index.append(pack(looks[:200]))
        index.alive[:200] = np.random.default_rng(seed).random(200) < 0.5
    old_of_new = indices[1].compact()
    plain, compacted = (index.assign(pack(looks[200:]), 0.9, learn=False, together=False) for index in indices)
    assert np.where(compacted >= 0, old_of_new[compacted], -1).tolist() == plain.tolist()


class Library(RuleBasedStateMachine):
    """Nodes come with words, go, and come back; a plain model keeps the books."""

    @initialize(seed=st.integers(0, 100))
    def start(self, seed: int) -> None:
        self.dictionary = Dictionary(seed=seed)
        self.rng = np.random.default_rng(seed)
        self.parents = random_descriptors(30, seed)
        self.looks: dict[int, NDArray[np.uint8]] = {}
        self.inside: list[NDArray[np.int32]] = []
        self.outside: list[NDArray[np.int32]] = []

    @rule(count=st.integers(1, 12))
    def a_node_comes(self, count: int) -> None:
        looks = np.array([flipped(self.parents[k], self.rng.integers(0, 256, 6).tolist()) for k in self._some(count)])
        ids, new_ids, new_descriptors = self.dictionary.quantize(looks, PARAMS)
        assert not set(new_ids.tolist()) & self.looks.keys(), "a number was given a second time"
        self.looks.update(zip(new_ids.tolist(), new_descriptors, strict=True))
        self._admit(np.unique(ids))

    @precondition(lambda self: self.inside)
    @rule(data=st.data())
    def a_node_goes(self, data: st.DataObject) -> None:
        ids = self.inside.pop(data.draw(st.integers(0, len(self.inside) - 1)))
        self.dictionary.release(ids.tolist())
        self.outside.append(ids)

    @precondition(lambda self: self.outside)
    @rule(data=st.data())
    def a_node_comes_back(self, data: st.DataObject) -> None:
        ids = self.outside.pop(data.draw(st.integers(0, len(self.outside) - 1)))
        in_ram = set(self.dictionary.ids())
        renamed = self.dictionary.restore(ids, np.array([self.looks[i] for i in ids.tolist()]), PARAMS)
        assert renamed.keys() == set(ids.tolist())
        for old, new in renamed.items():
            assert new == old or (old not in in_ram and new in in_ram)
        self._admit(np.unique(list(renamed.values())))

    @invariant()
    def the_words_are_those_in_use(self) -> None:
        assert self.dictionary.ids() == sorted({int(i) for ids in self.inside for i in ids})

    @invariant()
    def words_look_as_when_they_were_made(self) -> None:
        ids = np.array(self.dictionary.ids(), np.int32)
        if len(ids):
            looks = np.array([self.looks[i] for i in ids.tolist()])
            np.testing.assert_array_equal(self.dictionary.descriptors(ids), looks)

    def _some(self, count: int) -> list[int]:
        return [int(k) for k in self.rng.integers(0, len(self.parents), count)]

    def _admit(self, ids: NDArray[np.int32]) -> None:
        self.dictionary.use(ids.tolist())
        self.inside.append(ids)


TestLibrary = Library.TestCase
TestLibrary.settings = settings(max_examples=15, stateful_step_count=25, deadline=None)
