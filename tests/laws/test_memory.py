"""Whatever comes, goes and comes back: each node is in one tier, nothing is lost, weights and words add up."""

from __future__ import annotations

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from numpy.typing import NDArray

from slam.features.hamming import distance, pack
from slam.loop.likelihood import WordBag
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import Node, Tier
from tests.nodes import features, flipped, node, random_descriptors


class Traffic(RuleBasedStateMachine):
    """Nodes with look-alike words move between the tiers as they like."""

    @initialize(seed=st.integers(0, 100), size=st.integers(1, 5))
    def start(self, seed: int, size: int) -> None:
        self.params = Params().changed({"Mem/STMSize": size, "Kp/MaxFeatures": 12})
        self.memory = Memory(RamMemory(), seed=seed)
        self.rng = np.random.default_rng(seed)
        self.parents = random_descriptors(25, seed)
        self.added: list[Node] = []
        self.looks: dict[int, NDArray[np.uint8]] = {}
        self.tiers: dict[int, Tier] = {}
        self.in_wm: list[int] = []

    @rule(count=st.integers(0, 16))
    def a_node_is_added(self, count: int) -> None:
        before = set(self.memory.dictionary.ids())
        new = self._node(count)
        self.memory.add(new, self.params)
        self.added.append(new)
        assert before <= set(self.memory.dictionary.ids())
        overflow = len(self._in(Tier.STM)) + 1 - self.params.Mem.STMSize
        for node_id in sorted(self._in(Tier.STM))[: max(0, overflow)]:
            self.tiers[node_id] = Tier.WM
            self.in_wm.append(node_id)
        self.tiers[new.id] = Tier.STM

    @rule(count=st.integers(0, 16))
    def a_node_is_looked_at_and_not_kept(self, count: int) -> None:
        before = self.memory.dictionary.ids()
        self.memory.forget_words(self._node(count))
        assert self.memory.dictionary.ids() == before

    @rule(size=st.integers(1, 5))
    def short_term_memory_is_resized(self, size: int) -> None:
        self.params = self.params.changed({"Mem/STMSize": size})

    @precondition(lambda self: self._in(Tier.WM))
    @rule(data=st.data())
    def nodes_are_transferred(self, data: st.DataObject) -> None:
        ids = data.draw(st.lists(st.sampled_from(sorted(self._in(Tier.WM))), min_size=1, unique=True))
        self.memory.transfer(ids)
        self.tiers.update(dict.fromkeys(ids, Tier.LTM))
        self.in_wm = [i for i in self.in_wm if i not in ids]

    @precondition(lambda self: self._in(Tier.LTM))
    @rule(data=st.data())
    def nodes_come_back(self, data: st.DataObject) -> None:
        ids = data.draw(st.lists(st.sampled_from(sorted(self.tiers)), min_size=1, unique=True))
        found = self.memory.retrieve(ids, self.params)
        assert found == [i for i in ids if self.tiers[i] is Tier.LTM], "only those that were away"
        self.tiers.update(dict.fromkeys(found, Tier.WM))
        self.in_wm += found
        for node_id, words in self.memory.take_renamed().items():
            for old, new in words.items():
                away = distance(pack(self.looks[old][None])[0], pack(self.looks[new][None])[0])
                assert old != new
                assert away <= 0.8 * 64, f"word {old} of node {node_id} became {new}, which looks different"

    @invariant()
    def each_node_is_in_one_tier(self) -> None:
        stm, wm, ltm = set(self.memory.stm), set(self.memory.wm), self.memory.ltm
        assert len(stm) + len(wm) + len(ltm) == len(self.added) == len(stm | wm | ltm)
        for tier, ids in ((Tier.STM, stm), (Tier.WM, wm), (Tier.LTM, ltm)):
            assert ids == self._in(tier)
            assert all(self.memory.tier(i) is tier for i in ids)

    @invariant()
    def short_term_memory_holds_the_newest(self) -> None:
        ids = [one.id for one in self.added]
        assert list(self.memory.stm) == ids[len(ids) - len(self.memory.stm) :]
        assert len(self.memory.stm) <= 5

    @invariant()
    def working_memory_knows_who_came_first(self) -> None:
        assert sorted(self.memory.wm, key=lambda i: self.memory.wm[i]) == self.in_wm

    @invariant()
    def whole_nodes_are_in_ram_and_as_they_were(self) -> None:
        assert self.memory.nodes.keys() == self.memory.bags.keys() == {*self.memory.stm, *self.memory.wm}
        for one in self.added:
            if one.id in self.memory.nodes:
                self._same(self.memory.nodes[one.id], one)

    @invariant()
    def weights_are_never_lost(self) -> None:
        assert self.memory.weights.keys() == self.tiers.keys()

    @invariant()
    def the_dictionary_has_the_words_of_ram(self) -> None:
        used = {int(w) for bag in self.memory.bags.values() for w in bag.words}
        assert set(self.memory.dictionary.ids()) == used

    @rule()
    def moves_are_told_once(self) -> None:
        told = self.memory.take_moves()
        assert all(self.tiers[i] is tier for i, tier in told.items())
        assert self.memory.take_moves() == {}

    def _in(self, tier: Tier) -> set[int]:
        return {i for i, t in self.tiers.items() if t is tier}

    def _node(self, count: int) -> Node:
        looks = [
            flipped(self.parents[self.rng.integers(25)], self.rng.integers(0, 256, 8).tolist()) for _ in range(count)
        ]
        items = features(np.array(looks, np.uint8).reshape(-1, 32))
        word_ids, words = self.memory.quantize(items, self.params)
        self.looks.update(zip(words.ids.tolist(), words.descriptors, strict=True))
        best = min(count, 12)
        assert (word_ids[:best] > 0).all()
        assert word_ids[best:].tolist() == [-k for k in range(1, count - best + 1)]
        return node(len(self.added) + 1, items, word_ids)

    def _same(self, found: Node, made: Node) -> None:
        for name in ("pixels", "descriptors", "points_base", "responses"):
            np.testing.assert_array_equal(getattr(found.features, name), getattr(made.features, name))
        assert ((found.word_ids > 0) == (made.word_ids > 0)).all()
        bag = self.memory.bags[made.id]
        assert bag.words.tolist() == WordBag.of(found).words.tolist()
        assert bag.features == max(1, len(made.word_ids))


TestTraffic = Traffic.TestCase
TestTraffic.settings = settings(max_examples=25, stateful_step_count=30, deadline=None)
