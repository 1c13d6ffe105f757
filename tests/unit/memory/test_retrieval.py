"""Who comes back from long-term memory: beside the hypothesis, and near the robot."""

from __future__ import annotations

import pytest

from slam.graph.graph import PoseGraph
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.memory.places import Places
from slam.memory.retrieval import choose_retrieval
from slam.params import Params, Value
from tests.nodes import add_place, at, join, random_descriptors


def away(ids: set[int], **changes: Value) -> tuple[Memory, PoseGraph, Params]:
    """A walk of 30 nodes a metre apart, of which these are in long-term memory; nothing comes back by place."""
    values: dict[str, Value] = {"Mem/STMSize": 2, "RGBD/MaxLocalRetrieved": 0}
    params = Params().changed(values | {name.replace("_", "/"): value for name, value in changes.items()})
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    for node_id in range(1, 31):
        add_place(memory, graph, random_descriptors(3, node_id), params, pose=at(float(node_id)))
    memory.transfer(sorted(ids))
    return memory, graph, params


def chosen(memory: Memory, graph: PoseGraph, params: Params, best_id: int = 0) -> list[int]:
    places = Places()
    places.put(graph.poses, sorted(memory.ltm))
    return choose_retrieval(memory, graph, places, node_id=30, best_id=best_id, params=params)


def test_the_nearest_in_time_of_the_hypothesis_come_first() -> None:
    memory, graph, params = away({5, 7, 9, 10, 15})
    assert chosen(memory, graph, params, 8) == [7, 9]
    assert set(chosen(memory, graph, params.changed({"Rtabmap/MaxRetrieved": 4}), 8)) == {7, 9, 10, 5}


def test_neighbours_in_time_come_before_those_by_a_loop() -> None:
    memory, graph, params = away({12, 25})
    join(graph, 25, 10)
    assert chosen(memory, graph, params, 10) == [12, 25]
    assert chosen(memory, graph, params.changed({"Rtabmap/MaxRetrieved": 1}), 10) == [12]


@pytest.mark.parametrize("most", [0, 1, 3])
def test_no_more_come_back_than_the_parameter_allows(most: int) -> None:
    memory, graph, params = away(set(range(1, 20)) - {8}, Rtabmap_MaxRetrieved=most)
    assert len(chosen(memory, graph, params, 8)) == most


def test_without_a_hypothesis_nothing_comes_back_by_it() -> None:
    memory, graph, params = away({5, 7})
    assert chosen(memory, graph, params) == []


@pytest.mark.parametrize(
    ("most", "radius", "expected"), [(2, 10.0, [3, 4]), (3, 10.0, [3, 4, 5]), (0, 10.0, []), (9, 3.5, [3])]
)
def test_the_closest_to_the_robot_come_back(most: int, radius: float, expected: list[int]) -> None:
    memory, graph, params = away({3, 4, 5, 20}, RGBD_MaxLocalRetrieved=most, RGBD_LocalRadius=radius)
    graph.poses[30] = at(0.0)
    assert chosen(memory, graph, params) == expected


def test_nobody_is_named_twice() -> None:
    memory, graph, params = away({3, 4, 5}, RGBD_MaxLocalRetrieved=2)
    graph.poses[30] = at(3.0)
    assert chosen(memory, graph, params, 2) == [3, 4, 5]


def test_who_is_in_ram_is_not_brought_back() -> None:
    memory, graph, params = away(set(), RGBD_MaxLocalRetrieved=5)
    assert chosen(memory, graph, params, 8) == []
