"""The detector: which belief it forms, and whom it asks the images about."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.clock import StageClock
from slam.graph.graph import PoseGraph
from slam.loop.detector import Belief, LoopDetector
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.params import Params
from slam.types import Node, Posterior
from tests.nodes import add_place, at, random_descriptors

PARAMS = Params().changed({"Mem/STMSize": 3, "RGBD/ProximityBySpace": False})


def seen_at(place: int) -> NDArray[np.uint8]:
    """27 words of the place alone, and 3 that every third place has too."""
    return np.concatenate([random_descriptors(27, place), random_descriptors(3, 1000 + place % 3)])


class Walk:
    """Places with words of their own; ``see`` adds a node that shows the words of a place."""

    def __init__(self, params: Params = PARAMS) -> None:
        self.memory, self.graph = Memory(RamMemory(), seed=0), PoseGraph()
        self.detector, self.params = LoopDetector(), params
        self.beliefs: list[Belief] = []

    def see(self, place: int, descriptors: NDArray[np.uint8] | None = None) -> tuple[Node, Belief]:
        looks = seen_at(place) if descriptors is None else descriptors
        position = at(5.0 * len(self.graph), 0.0)
        node = add_place(self.memory, self.graph, looks, self.params, pose=position)
        belief = self.detector.recognize(node, self.memory, self.graph, self.params, StageClock())
        self.beliefs.append(belief)
        return node, belief


def test_new_places_are_new() -> None:
    walk = Walk()
    for place in range(1, 12):
        _, belief = walk.see(place)
        assert belief.posterior is not None
        if place > 8:  # with few places to choose from, all start equal and are likely
            assert belief.place == 0
            assert belief.refused == f"hypothesis {belief.posterior.value:.3f} is below Rtabmap/LoopThr 0.11"
        assert belief.posterior.node_ids.tolist() == sorted(walk.memory.wm)


def test_a_place_seen_again_is_named() -> None:
    walk = Walk()
    for place in range(1, 12):
        walk.see(place)
    found = [walk.see(place)[1].place for place in (2, 3, 4, 5)]
    assert found[-2:] == [4, 5]
    last = walk.beliefs[-1]
    assert last.refused == ""
    assert last.posterior is not None
    assert last.posterior.value >= PARAMS.Rtabmap.LoopThr
    assert last.likelihood[5] == max(last.likelihood.values()) > 1


def test_a_node_with_few_words_is_not_judged() -> None:
    walk = Walk()
    for place in range(1, 8):
        walk.see(place)
    _, belief = walk.see(2, seen_at(2)[:13])
    assert belief.posterior is None
    assert belief.place == 0
    assert belief.refused == "13 words, fewer than Kp/BadSignRatio 0.5 of the usual number"
    assert belief.likelihood == {}
    assert walk.see(2, seen_at(2)[:15])[1].posterior is not None


def test_only_the_place_believed_in_is_registered() -> None:
    walk = Walk()
    for place in range(1, 12):
        walk.see(place)
    for place in (2, 3, 4):
        node, belief = walk.see(place)
    tried = walk.detector.candidates(node, belief, walk.memory, walk.graph, walk.params, StageClock())
    assert [(one.from_id, one.to_id) for one in tried] == [(node.id, belief.place)]
    assert tried[0].posterior == pytest.approx(belief.posterior.value if belief.posterior else -1)
    nobody = walk.detector.candidates(node, Belief(None), walk.memory, walk.graph, walk.params, StageClock())
    assert nobody == []


def test_a_node_joined_already_is_not_tried_again() -> None:
    walk = Walk()
    for place in range(1, 6):
        node, _ = walk.see(place)
    neighbour = node.id - 1
    posterior = Posterior(np.array([neighbour], np.int32), np.ones(1), np.ones(1), 0.0, 1.0)
    belief = Belief(posterior, place=neighbour)
    assert walk.detector.candidates(node, belief, walk.memory, walk.graph, walk.params, StageClock()) == []


def test_stages_are_timed_under_their_names() -> None:
    walk = Walk()
    clock = StageClock()
    node, belief = walk.see(1)
    walk.detector.recognize(node, walk.memory, walk.graph, PARAMS.changed({"RGBD/ProximityBySpace": True}), clock)
    params = PARAMS.changed({"RGBD/ProximityBySpace": True})
    walk.detector.candidates(node, belief, walk.memory, walk.graph, params, clock)
    assert clock.values.keys() == {
        "Timing/Likelihood_computation/ms",
        "Timing/Posterior_computation/ms",
        "Timing/Hypotheses_validation/ms",
        "Timing/Proximity_by_space/ms",
    }
    assert all(value >= 0 for value in clock.values.values())
