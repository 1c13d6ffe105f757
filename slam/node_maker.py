"""Nodes made of frames, before anything is done with them."""

from __future__ import annotations

import numpy as np

from slam.database import WordRows
from slam.features.words import NodeFeatures
from slam.loop.likelihood import WordBag
from slam.memory.memory import Memory
from slam.memory.signature import too_few_words
from slam.params import Params
from slam.types import WEIGHT_INTERMEDIATE, Frame, Node, Odometry


class NodeMaker:
    """Gives nodes their words, and ids that go on from the newest one.

    Attributes:
        newest_id: of a node that was kept.
        map_id: its session.
    """

    def __init__(self, memory: Memory, newest_id: int, map_id: int) -> None:
        self.newest_id, self.map_id = newest_id, map_id
        self._memory = memory
        self._features = NodeFeatures()

    def make(self, frame: Frame, odometry: Odometry, params: Params, *, anew: bool) -> tuple[Node, WordRows]:
        """The node of a tracked frame, the first of a new session or not, and the words that are new with it."""
        assert odometry.T_odom_base is not None
        features, best = self._features.of(frame, odometry.features, params)
        adopted = None if frame.stored is None else self._memory.adopt(frame.stored)
        word_ids, words = adopted or self._memory.quantize(features, params, best)
        node = Node(
            id=self.newest_id + 1,
            map_id=self.map_id + int(anew),
            weight=0,
            stamp=frame.stamp,
            T_odom_base=odometry.T_odom_base,
            features=features,
            word_ids=word_ids,
            camera=frame.camera,
            T_world_base=frame.T_world_base,
        )
        return node, words

    def make_between(self, frame: Frame, odometry: Odometry) -> Node:
        """The intermediate node of a tracked frame: a pose on the path, with nothing that it could be recognised by."""
        assert odometry.T_odom_base is not None
        return Node(
            id=self.newest_id + 1,
            map_id=self.map_id,
            weight=WEIGHT_INTERMEDIATE,
            stamp=frame.stamp,
            T_odom_base=odometry.T_odom_base,
            features=odometry.features.take(np.zeros(0, np.int64)),
            word_ids=np.zeros(0, np.int32),
            camera=frame.camera,
            T_world_base=frame.T_world_base,
        )

    def keep(self, node: Node) -> None:
        """The node was taken into the map."""
        self.newest_id, self.map_id = node.id, node.map_id

    def is_useless(self, node: Node, params: Params, *, begins: bool) -> bool:
        """Whether a node has too few words to be kept (``Mem/BadSignaturesIgnored``), or to begin with."""
        asked = (begins and params.Rtabmap.StartNewMapOnGoodSignature) or params.Mem.BadSignaturesIgnored
        return asked and too_few_words(WordBag.of(node), self._memory, params) is not None
