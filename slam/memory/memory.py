"""The three memories and the moves between them."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from slam.database import WordRows
from slam.features.dictionary import Dictionary
from slam.features.fixed_dictionary import FixedDictionary
from slam.loop.likelihood import WordBag
from slam.memory.long_term import LongTermMemory
from slam.params import Params
from slam.types import WEIGHT_INTERMEDIATE, Features, Node, Stored, Tier


class Memory:
    """Which node is where; nodes in RAM (STM and WM) with features and words, the others without.

    Attributes:
        stm: ids, oldest first.
        wm: id -> when it entered working memory (a counter, not a time).
        ltm: ids.
        nodes: whole nodes of STM and WM.
        bags: their words.
        weights: of all nodes.
        between: id -> the intermediate nodes that follow it on the path; they are always in the memory that it is in.
        dictionary: the words in RAM.
    """

    def __init__(
        self, long_term: LongTermMemory, *, seed: int, dictionary: Dictionary | FixedDictionary | None = None
    ) -> None:
        self.stm: deque[int] = deque()
        self.wm: dict[int, int] = {}
        self.ltm: set[int] = set()
        self.nodes: dict[int, Node] = {}
        self.bags: dict[int, WordBag] = {}
        self.weights: dict[int, int] = {}
        self.between: dict[int, list[int]] = {}
        self.dictionary = Dictionary(seed=seed) if dictionary is None else dictionary
        self._long_term = long_term
        self._outlines: dict[int, Node] = {}
        self._moved: dict[int, Tier] = {}
        self._renamed: dict[int, dict[int, int]] = {}
        self._reweighed: dict[int, int] = {}
        self._adopted: set[int] = set()
        self._entries = 0

    def quantize(
        self, features: Features, params: Params, count: int | None = None
    ) -> tuple[NDArray[np.int32], WordRows]:
        """Word ids of features: the first ``count`` (``Kp/MaxFeatures``) become words, the rest get negative ids."""
        best = min(len(features), params.Kp.MaxFeatures if count is None else count)
        words, new_ids, new_descriptors = self.dictionary.quantize(features.descriptors[:best], params)
        rest = -np.arange(1, len(features) - best + 1, dtype=np.int32)
        return np.concatenate([words, rest]).astype(np.int32), WordRows(new_ids, new_descriptors)

    def adopt(self, stored: Stored) -> tuple[NDArray[np.int32], WordRows] | None:
        """Word ids of a replayed frame's features as they were, and those words that no node had before.

        None where they are to be looked for: the frame has none, or the dictionary is a fixed one.
        """
        if stored.features is None or stored.word_ids is None or stored.word_descriptors is None:
            return None
        if not isinstance(self.dictionary, Dictionary):
            return None
        ids = np.unique(stored.word_ids)
        self.dictionary.adopt(ids, stored.word_descriptors)
        new = ~np.isin(ids, list(self._adopted))
        self._adopted.update(ids.tolist())
        rest = -np.arange(1, len(stored.features) - len(stored.word_ids) + 1, dtype=np.int32)
        return np.concatenate([stored.word_ids, rest]), WordRows(ids[new], stored.word_descriptors[new])

    def forget_words(self, node: Node) -> None:
        """The words made for a node that is not kept go again."""
        bag = WordBag.of(node)
        self.dictionary.discard(bag.words.tolist())

    def add(self, node: Node, params: Params) -> list[int]:
        """Takes a new node into STM; what overflows goes to WM: the ids of those."""
        self._admit(node)
        self.weights[node.id] = node.weight
        self.stm.append(node.id)
        self._moved[node.id] = Tier.STM
        left = [self.stm.popleft() for _ in range(len(self.stm) - params.Mem.STMSize)]
        for node_id in left:
            self._enter_wm(node_id)
        return left

    def add_between(self, node: Node) -> None:
        """Takes in an intermediate node, which follows the newest one of STM."""
        self.weights[node.id] = node.weight
        self.between.setdefault(self.stm[-1], []).append(node.id)
        self._moved[node.id] = Tier.STM

    def with_between(self, ids: Iterable[int]) -> list[int]:
        """These nodes, each with the intermediate ones that follow it."""
        return [i for node_id in ids for i in (node_id, *self.between.get(node_id, ()))]

    def make_between(self, node_id: int, follows: int) -> None:
        """A node in RAM becomes an intermediate one, which follows another."""
        self.hand_over(node_id, follows)
        self.dismiss(node_id)
        self.set_weight(node_id, WEIGHT_INTERMEDIATE)
        self.between.setdefault(follows, []).append(node_id)
        self._moved[node_id] = self.tier(follows)

    def hand_over(self, node_id: int, to_id: int) -> None:
        """The intermediate nodes that follow one node are with another from now on."""
        handed = self.between.pop(node_id, [])
        if handed:
            self.between.setdefault(to_id, []).extend(handed)
            self._moved |= dict.fromkeys(handed, self.tier(to_id))

    def dismiss(self, node_id: int) -> None:
        """Lets a node in RAM go for good, with the words that it alone had."""
        if self.wm.pop(node_id, None) is None:
            self.stm.remove(node_id)
        del self.nodes[node_id], self.weights[node_id]
        self.dictionary.release(self.bags.pop(node_id).words.tolist())
        self._moved.pop(node_id, None)
        self._reweighed.pop(node_id, None)

    def transfer(self, ids: Iterable[int]) -> None:
        """Moves nodes from WM to LTM: features and unused words leave RAM."""
        for node_id in ids:
            node = self.nodes.pop(node_id)
            self._long_term.store(node, self._words_of(node))
            nothing = node.features.take(np.zeros(0, np.int64))
            self._outlines[node_id] = replace(node, features=nothing, scan=None, images=None)
            self.dictionary.release(self.bags.pop(node_id).words.tolist())
            del self.wm[node_id]
            self.ltm.add(node_id)
            self._moved |= dict.fromkeys(self.with_between([node_id]), Tier.LTM)

    def retrieve(self, ids: Iterable[int], params: Params) -> list[int]:
        """Brings nodes back from LTM to WM; returns those that were there."""
        found = [node_id for node_id in ids if node_id in self.ltm]
        nodes = self._long_term.load([self._outlines.pop(node_id) for node_id in found]) if found else []
        words = self._absent_words(nodes)
        for node_id, node in zip(found, nodes, strict=True):
            its = np.isin(words.ids, node.word_ids)
            in_ram = self.dictionary.restore(words.ids[its], words.descriptors[its], params)
            word_ids = np.array([in_ram.get(w, w) for w in node.word_ids.tolist()], np.int32)
            renamed = {old: new for old, new in in_ram.items() if old != new}
            if renamed:
                self._renamed[node_id] = renamed
            self._admit(replace(node, word_ids=word_ids, weight=self.weights[node_id]))
            self.ltm.remove(node_id)
            self._enter_wm(node_id)
        return found

    def recall(
        self,
        outlines: Iterable[Node],
        in_ram: Iterable[int],
        words: WordRows,
        next_word_id: int,
        between: Mapping[int, Iterable[int]] = MappingProxyType({}),
    ) -> None:
        """Starts with the nodes of a map file: ``in_ram`` come to WM, the others are in LTM.

        Args:
            outlines: all nodes, ascending, without features.
            in_ram: ids among them.
            words: at least those that the nodes in RAM use.
            next_word_id: the first id that no word of the file has.
            between: id -> the intermediate nodes that follow it.
        """
        self._outlines = {outline.id: outline for outline in outlines}
        self.between = {node_id: list(ids) for node_id, ids in between.items()}
        self.weights = {outline.id: outline.weight for outline in self._outlines.values()}
        self.weights |= {i: WEIGHT_INTERMEDIATE for ids in self.between.values() for i in ids}
        nodes = self._long_term.load([self._outlines.pop(node_id) for node_id in sorted(in_ram)])
        self.ltm = set(self._outlines)
        self._moved = dict.fromkeys(self.with_between(self.ltm), Tier.LTM)
        used = np.unique(np.concatenate([np.zeros(0, np.int32), *(node.word_ids for node in nodes)]))
        kept = np.isin(words.ids, used)
        self.dictionary.load(words.ids[kept], words.descriptors[kept], next_word_id)
        for node in nodes:
            # What is not in the file's dictionary can't be recognised: it counts as a key point that is no word.
            known = np.isin(node.word_ids, words.ids)
            self._admit(replace(node, word_ids=np.where(known, node.word_ids, np.minimum(node.word_ids, -1))))
            self._enter_wm(node.id)

    def set_weight(self, node_id: int, weight: int) -> None:
        """Another weight for a node that may be in the map file already."""
        self.weights[node_id] = self._reweighed[node_id] = weight

    def in_ram(self) -> tuple[int, ...]:
        """Ids in short-term and working memory, ascending."""
        return tuple(sorted(self.with_between([*self.stm, *self.wm])))

    def tier(self, node_id: int) -> Tier:
        """The memory a node is in."""
        if node_id in self.wm:
            return Tier.WM
        return Tier.LTM if node_id in self.ltm else Tier.STM

    def take_moves(self) -> dict[int, Tier]:
        """Tiers that changed since this was last asked."""
        moved, self._moved = self._moved, {}
        return moved

    def take_weights(self) -> dict[int, int]:
        """Weights set since this was last asked."""
        weights, self._reweighed = self._reweighed, {}
        return weights

    def take_renamed(self) -> dict[int, dict[int, int]]:
        """Node -> old word -> word in RAM, of nodes that came back since this was last asked."""
        renamed, self._renamed = self._renamed, {}
        return renamed

    def _admit(self, node: Node) -> None:
        self.nodes[node.id] = node
        self.bags[node.id] = WordBag.of(node)
        self.dictionary.use(self.bags[node.id].words.tolist())

    def _enter_wm(self, node_id: int) -> None:
        self._entries += 1
        self.wm[node_id] = self._entries
        self._moved |= dict.fromkeys(self.with_between([node_id]), Tier.WM)

    def _absent_words(self, nodes: Iterable[Node]) -> WordRows:
        """The words of nodes that come back, but those that the dictionary has."""
        ids = {word for node in nodes for word in node.word_ids.tolist() if word > 0}
        absent = self.dictionary.absent(ids)
        return self._long_term.words(absent) if absent else WordRows.none()

    def _words_of(self, node: Node) -> WordRows:
        ids = np.unique(node.word_ids[node.word_ids > 0])
        return WordRows(ids, self.dictionary.descriptors(ids))
