"""Rehearsal: which nodes are alike, what that does to weights, and when a node counts as moved."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import Pose, make, so3_exp
from slam.graph.graph import PoseGraph
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.memory.rehearsal import moved, rehearse
from slam.params import Params
from slam.types import Node
from tests.nodes import add_place, at, features, node, random_descriptors

PARAMS = Params()


def second(memory: Memory, common: int, total: int = 20, *, pose: Pose | None = None) -> Node:
    """A node that shares so many of its words with the first one of ``one_place``."""
    looks = np.concatenate([random_descriptors(20, 1)[:common], random_descriptors(total, 2)[: total - common]])
    items = features(looks)
    word_ids, _ = memory.quantize(items, PARAMS)
    return node(2, items, word_ids, pose=at(0.5) if pose is None else pose)


def one_place() -> Memory:
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    add_place(memory, graph, random_descriptors(20, 1), PARAMS, pose=at(0.0))
    return memory


@pytest.mark.parametrize(("common", "alike"), [(20, True), (12, True), (11, False), (0, False)])
def test_the_share_of_common_words_decides(common: int, alike: bool) -> None:
    memory = one_place()
    found = rehearse(second(memory, common), memory, PARAMS)
    assert (found is not None) == alike
    if found is not None:
        assert found.similarity == pytest.approx(common / 20)
        assert found.node_id == 1


def test_the_share_is_of_the_larger_node() -> None:
    memory = one_place()
    assert rehearse(second(memory, 20, 33), memory, PARAMS) is not None  # 20 of 33
    assert rehearse(second(memory, 20, 34), memory, PARAMS) is None


def test_the_older_node_gets_the_weight_of_both_and_one_more() -> None:
    memory = one_place()
    memory.weights[1] = 6
    found = rehearse(second(memory, 20), memory, PARAMS)
    assert found is not None
    assert found.weight == 7


def test_one_is_off_and_nothing_is_compared_with_nothing() -> None:
    memory = one_place()
    assert rehearse(second(memory, 20), memory, PARAMS.changed({"Mem/RehearsalSimilarity": 1.0})) is None
    assert rehearse(second(memory, 20), Memory(RamMemory(), seed=0), PARAMS) is None


def test_only_the_last_node_is_compared() -> None:
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    add_place(memory, graph, random_descriptors(20, 1), PARAMS, pose=at(0.0))
    add_place(memory, graph, random_descriptors(20, 9), PARAMS, pose=at(1.0))
    assert rehearse(second(memory, 20), memory, PARAMS) is None


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize(("size", "far"), [(0.099, False), (0.101, True), (-0.101, True)])
def test_moved_by_a_tenth_on_any_axis(axis: int, size: float, far: bool) -> None:
    offset = np.zeros(3)
    offset[axis] = size
    items = features(random_descriptors(3, 0))
    words = np.arange(1, 4, dtype=np.int32)
    start = make(so3_exp(np.array([0.4, -0.2, 2.0])), np.array([3.0, -1.0, 0.5]))
    last = node(1, items, words, pose=start)
    assert moved(last, node(2, items, words, pose=start @ make(np.eye(3), offset)), PARAMS) == far
    assert moved(last, node(2, items, words, pose=start @ make(so3_exp(offset), np.zeros(3))), PARAMS) == far


@settings(max_examples=30, deadline=None)
@given(st.floats(0.01, 2.0), st.floats(0.01, 1.0), st.floats(0, 2.0), st.floats(0, 1.0))
def test_the_thresholds_are_parameters(linear: float, angular: float, metres: float, radians: float) -> None:
    items, words = features(random_descriptors(3, 0)), np.arange(1, 4, dtype=np.int32)
    params = PARAMS.changed({"RGBD/LinearUpdate": linear, "RGBD/AngularUpdate": angular})
    there = make(so3_exp(np.array([0, 0, radians])), np.array([0, metres, 0]))
    found = moved(node(1, items, words, pose=np.eye(4)), node(2, items, words, pose=there), params)
    if abs(metres - linear) > 1e-6 and abs(radians - angular) > 1e-6:
        assert found == (metres > linear or radians > angular)


def test_a_node_of_another_session_counts_as_moved() -> None:
    items, words = features(random_descriptors(3, 0)), np.arange(1, 4, dtype=np.int32)
    assert moved(node(1, items, words, pose=at(0)), node(2, items, words, pose=at(0), map_id=1), PARAMS)
    assert not moved(node(1, items, words, pose=at(0)), node(2, items, words, pose=at(0)), PARAMS)
