"""Where nodes go that leave RAM, and come back from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from slam.database import MapReader, WordRows
from slam.types import Descriptors, Node


class LongTermMemory(Protocol):
    """Keeps whole nodes outside working memory."""

    def store(self, node: Node, words: WordRows) -> None:
        """Takes in a node that leaves working memory, with the words it uses."""
        ...

    def load(self, nodes: Sequence[Node]) -> list[Node]:
        """Whole nodes, features and all, of nodes without them."""
        ...

    def words(self, ids: Sequence[int]) -> WordRows:
        """Words of nodes that are here, ascending by id, those of them that there are."""
        ...


class DatabaseMemory:
    """The map file is the long-term memory: nodes are in it from the moment they are made."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader

    def store(self, node: Node, words: WordRows) -> None:
        """Nothing is left to do: the file has it."""

    def load(self, nodes: Sequence[Node]) -> list[Node]:
        """Reads features and clouds of nodes; their images stay where they are."""
        seen = self._reader.seen([node.id for node in nodes])
        return [
            replace(node, features=features, word_ids=word_ids, scan=scan, images=None)
            for node, (features, word_ids, scan) in zip(nodes, seen, strict=True)
        ]

    def words(self, ids: Sequence[int]) -> WordRows:
        """Reads them."""
        return self._reader.words(ids)


class RamMemory:
    """Keeps everything in RAM, for runs without a map file."""

    def __init__(self) -> None:
        self._nodes: dict[int, Node] = {}
        self._words: dict[int, Descriptors] = {}

    def store(self, node: Node, words: WordRows) -> None:
        """Keeps a node and its words."""
        self._nodes[node.id] = node
        self._words.update(zip(words.ids.tolist(), words.descriptors, strict=True))

    def load(self, nodes: Sequence[Node]) -> list[Node]:
        """Hands back what was stored."""
        return [self._nodes[node.id] for node in nodes]

    def words(self, ids: Sequence[int]) -> WordRows:
        """Hands back what was stored."""
        known = sorted(word for word in ids if word in self._words)
        if not known:
            return WordRows.none()
        return WordRows(np.array(known, np.int32), np.array([self._words[word] for word in known]))
