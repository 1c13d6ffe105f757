"""Where nodes go that leave RAM, and come back from."""

from __future__ import annotations

from typing import Protocol

from slam.database import MapReader, WordRows
from slam.types import Node


class LongTermMemory(Protocol):
    """Keeps whole nodes outside working memory."""

    def store(self, node: Node, words: WordRows) -> None:
        """Takes in a node that leaves working memory, with the words it uses."""
        ...

    def load(self, node: Node) -> tuple[Node, WordRows]:
        """The whole node, features and all, of a node without them, and the words it uses."""
        ...


class DatabaseMemory:
    """The map file is the long-term memory: nodes are in it from the moment they are made."""

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader

    def store(self, node: Node, words: WordRows) -> None:
        """Nothing is left to do: the file has it."""

    def load(self, node: Node) -> tuple[Node, WordRows]:
        """Reads features, words and cloud of a node; its images stay where they are."""
        features, word_ids = self._reader.features(node.id)
        whole = Node(
            node.id,
            node.map_id,
            node.weight,
            node.stamp,
            node.T_odom_base,
            features,
            word_ids,
            node.camera,
            node.T_world_base,
            self._reader.scan(node.id),
        )
        return whole, self._reader.words(sorted(set(word_ids[word_ids > 0].tolist())))


class RamMemory:
    """Keeps everything in RAM, for runs without a map file."""

    def __init__(self) -> None:
        self._nodes: dict[int, tuple[Node, WordRows]] = {}

    def store(self, node: Node, words: WordRows) -> None:
        """Keeps a node and its words."""
        self._nodes[node.id] = node, words

    def load(self, node: Node) -> tuple[Node, WordRows]:
        """Hands back what was stored."""
        return self._nodes[node.id]
