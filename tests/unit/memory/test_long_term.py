"""Nodes come back from long-term memory as they left, whether it is in RAM or in a map file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.database import MapReader, MapWriter, NodeRecord, WordRows
from slam.errors import DatabaseError
from slam.memory.long_term import DatabaseMemory, RamMemory
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import Node, Odometry, Scan, Update
from tests.nodes import features, flipped, node, random_descriptors

PARAMS = Params().changed({"Mem/STMSize": 1, "Kp/MaxFeatures": 15})


class Map:
    """A memory with or without a map file behind it, filled as ``Slam`` does."""

    def __init__(self, path: Path | None) -> None:
        self.writer = None if path is None else MapWriter.create(path, PARAMS, seed=0, source="made up")
        self.memory = Memory(RamMemory() if path is None else DatabaseMemory(MapReader(path)), seed=0)
        self.count = 0

    def add(self, descriptors: NDArray[np.uint8], scan: Scan | None = None) -> Node:
        self.count += 1
        items = features(descriptors)
        word_ids, words = self.memory.quantize(items, PARAMS)
        new = replace(node(self.count, items, word_ids), scan=scan)
        self.memory.add(new, PARAMS)
        self.write(new, words)
        return new

    def write(self, new: Node, words: WordRows) -> None:
        renamed = self.memory.take_renamed()
        if self.writer is None:
            return
        odometry = Odometry(new.T_odom_base, np.eye(6), new.features, 30, 25, True, None, 1.0)
        update = Update(new.id, new.stamp, odometry, new.T_odom_base, new)
        self.writer.add_node(NodeRecord(node=new, update=update, words=words, renamed_words=renamed))


@pytest.fixture(params=["ram", "file"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Map]:
    made = Map(tmp_path / "map.db" if request.param == "file" else None)
    yield made
    if made.writer is not None:
        made.writer.close()


def assert_same(found: Node, made: Node) -> None:
    for name in ("pixels", "sizes", "angles", "responses", "octaves", "descriptors", "points_base"):
        a, b = getattr(found.features, name), getattr(made.features, name)
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(found.word_ids, made.word_ids)
    np.testing.assert_array_equal(found.T_odom_base, made.T_odom_base)
    assert (found.id, found.map_id, found.weight, found.stamp) == (made.id, made.map_id, made.weight, made.stamp)
    assert found.camera is made.camera


def test_nodes_come_back_equal_with_their_words(place: Map) -> None:
    made = [place.add(random_descriptors(20, seed)) for seed in range(6)]
    ids = place.memory.dictionary.ids()
    place.memory.transfer([1, 2, 3, 4, 5])
    assert len(place.memory.dictionary) == 15
    assert sorted(place.memory.retrieve([4, 2, 5, 1, 3], PARAMS)) == [1, 2, 3, 4, 5]
    for one in made:
        assert_same(place.memory.nodes[one.id], one)
    assert place.memory.dictionary.ids() == ids
    assert place.memory.take_renamed() == {}


def test_weights_that_changed_meanwhile_are_kept(place: Map) -> None:
    made = place.add(random_descriptors(20, 1))
    place.add(random_descriptors(20, 2))
    place.memory.transfer([1])
    place.memory.weights[1] = 7
    place.memory.retrieve([1], PARAMS)
    assert_same(place.memory.nodes[1], replace(made, weight=7))


def test_words_that_have_a_double_by_now_become_that_and_stay_so(place: Map) -> None:
    looks = random_descriptors(15, 1)
    place.add(looks)
    place.add(random_descriptors(15, 2))
    place.memory.transfer([1])
    place.add(np.array([flipped(d, [5, 100]) for d in looks]))  # the same place again, with new words 31 to 45
    place.memory.retrieve([1], PARAMS)
    assert place.memory.nodes[1].word_ids.tolist() == list(range(31, 46))
    place.add(random_descriptors(15, 3))
    place.memory.transfer([1])
    place.memory.retrieve([1], PARAMS)
    assert place.memory.nodes[1].word_ids.tolist() == list(range(31, 46)), "as it left the second time"
    if place.writer is not None:
        stored = MapReader(place.writer.path).features(1)[1]
        assert stored.tolist() == list(range(31, 46))


def test_a_file_refuses_words_that_it_does_not_have(tmp_path: Path) -> None:
    made = Map(tmp_path / "map.db")
    made.add(random_descriptors(5, 1))
    made.memory._renamed = {1: {1: 99}}
    with pytest.raises(DatabaseError, match="99 with node 2"):
        made.add(random_descriptors(5, 2))
    assert made.writer is not None
    made.writer.close()


def test_a_node_without_words_comes_back_too(place: Map) -> None:
    place.add(random_descriptors(0, 1).reshape(0, 32))
    place.add(random_descriptors(5, 1))
    place.memory.transfer([1])
    place.memory.retrieve([1], PARAMS)
    assert len(place.memory.nodes[1].features) == 0
    assert place.memory.bags[1].features == 1


@pytest.mark.parametrize("with_normals", [False, True])
def test_a_cloud_comes_back_with_its_node_and_takes_no_room_meanwhile(place: Map, with_normals: bool) -> None:
    points = np.random.default_rng(0).normal(size=(2, 50, 3)).astype(np.float32)
    scan = Scan(points[0], points[1] if with_normals else None)
    place.add(random_descriptors(20, 1), scan)
    place.add(random_descriptors(20, 2))
    place.memory.transfer([1])
    assert place.memory._outlines[1].scan is None
    assert place.memory.retrieve([1], PARAMS) == [1]
    back = place.memory.nodes[1].scan
    assert back is not None
    np.testing.assert_array_equal(back.points_base, scan.points_base)
    assert (back.normals_base is None) == (scan.normals_base is None)
    if scan.normals_base is not None:
        np.testing.assert_array_equal(back.normals_base, scan.normals_base)
    assert place.memory.nodes[2].scan is None
