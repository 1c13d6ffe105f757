"""What the earlier sessions of a map file leave to a new one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from slam.camera import Camera
from slam.database import MapReader
from slam.features.dictionary_file import open_dictionary
from slam.features.extract import kind_of_words
from slam.features.kind import check_kind
from slam.features.words import nothing_seen
from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.memory.long_term import DatabaseMemory
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import WEIGHT_INTERMEDIATE, Node, TrackedFrame


@dataclass(frozen=True, slots=True, eq=False)
class Past:
    """The state that a session goes on from.

    Attributes:
        reader: of the map file.
        graph: its nodes and links.
        memory: working memory as the last session left it, everything else in long-term memory.
        frames: all tracked frames.
        last_id: the largest id of a node, dropped ones included.
        T_map_base: where the robot was last, None when that is not known.
    """

    reader: MapReader
    graph: PoseGraph
    memory: Memory
    frames: list[TrackedFrame]
    last_id: int
    T_map_base: Pose | None


def recall(reader: MapReader, params: Params, *, seed: int) -> Past:
    """Reads what a new session needs of a map file, of slamdeck or of RTAB-Map.

    Working memory starts with what the last session had in RAM, or with all nodes (``Mem/InitWMWithAllNodes``).

    Raises:
        DatabaseError: the file can't be read.
        ParameterError: its words are not of the kind that is made now.
    """
    graph = PoseGraph.from_reader(reader)
    outlines = _outlines(reader, graph)
    left = {outline.id for outline in outlines}
    if not params.Mem.InitWMWithAllNodes:
        left &= set(reader.memory_ids()[0].tolist())
    dictionary = open_dictionary(params, seed=seed, map_path=reader.path)
    memory = Memory(DatabaseMemory(reader), seed=seed, dictionary=dictionary)
    words = reader.words()
    if len(words):
        check_kind(words.descriptors, kind_of_words(params))
    memory.recall(outlines, left, words, reader.last_word_id() + 1, _between(reader, outlines))
    last_id = int(reader.node_ids().max(initial=0))
    return Past(reader, graph, memory, reader.trajectory(), last_id, reader.last_pose())


def _outlines(reader: MapReader, graph: PoseGraph) -> list[Node]:
    """The nodes of the graph that have words and a camera, without their features, ascending."""
    table, cameras = reader.nodes(), reader.first_cameras()
    return [
        _outline(node_id, int(table.map_ids[row]), int(table.weights[row]), float(table.stamps[row]), graph, camera)
        for row, node_id in enumerate(table.ids.tolist())
        if node_id in graph and table.weights[row] >= 0 and (camera := cameras.get(node_id)) is not None
    ]


def _between(reader: MapReader, outlines: Iterable[Node]) -> dict[int, list[int]]:
    """Id -> the intermediate nodes that follow it in its session."""
    table, places, last = reader.nodes(), {outline.id: outline.map_id for outline in outlines}, 0
    found: dict[int, list[int]] = {}
    for node_id, map_id, weight in zip(table.ids.tolist(), table.map_ids.tolist(), table.weights.tolist(), strict=True):
        last = node_id if node_id in places else last
        if weight == WEIGHT_INTERMEDIATE and places.get(last) == map_id:
            found.setdefault(last, []).append(node_id)
    return found


def _outline(node_id: int, map_id: int, weight: int, stamp: float, graph: PoseGraph, camera: Camera) -> Node:
    return Node(node_id, map_id, weight, stamp, graph.T_odom[node_id], nothing_seen(), np.zeros(0, np.int32), camera)
