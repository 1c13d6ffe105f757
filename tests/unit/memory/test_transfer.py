"""Who leaves working memory, in which order, and who may not."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.graph.graph import PoseGraph
from slam.memory.immunity import Immunity
from slam.memory.long_term import RamMemory
from slam.memory.memory import Memory
from slam.memory.transfer import choose_transfer
from slam.params import Params, Value
from tests.nodes import add_place, at, join, random_descriptors

#: Nobody is immunised but for the neighbours of short-term memory.
BARE: dict[str, Value] = {
    "Mem/STMSize": 2,
    "Mem/RecentWmRatio": 0.0,
    "RGBD/LocalImmunizationRatio": 0.0,
    "Rtabmap/MemoryThr": 5,
}


def walked(count: int, params: Params, weights: dict[int, int] | None = None) -> tuple[Memory, PoseGraph]:
    """Nodes 1 .. count a metre apart on a line, each weighing what ``weights`` says, else 0."""
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    for node_id in range(1, count + 1):
        add_place(memory, graph, random_descriptors(3, node_id), params, pose=at(float(node_id)))
    memory.weights.update(weights or {})
    return memory, graph


def chosen(
    memory: Memory,
    graph: PoseGraph,
    params: Params,
    *,
    retrieved: list[int] | None = None,
    elapsed_ms: float = 0.0,
    best_id: int = 0,
    last_loop_id: int = 0,
) -> list[int]:
    immune = immunized(memory, graph, best_id, last_loop_id, params)
    return choose_transfer(memory, immune=immune, retrieved=retrieved or [], elapsed_ms=elapsed_ms, params=params)


def immunized(memory: Memory, graph: PoseGraph, best_id: int, last_loop_id: int, params: Params) -> frozenset[int]:
    return Immunity.of(memory, graph, graph, best_id, last_loop_id, params).ids


def params_with(**changes: Value) -> Params:
    return Params().changed(BARE | {name.replace("_", "/"): value for name, value in changes.items()})


def test_the_lightest_leaves_first_then_who_came_first() -> None:
    params = params_with()
    memory, graph = walked(10, params, {1: 3, 2: 1, 3: 0, 4: 1, 5: 0})
    assert chosen(memory, graph, params, retrieved=[6, 7]) == [3, 5, 2, 4]


def test_coming_back_makes_a_node_young() -> None:
    params = params_with()
    memory, graph = walked(10, params)
    memory.transfer([1])
    memory.retrieve([1], params)
    assert chosen(memory, graph, params) == [2, 3]
    by_id = params.changed({"Mem/TransferSortingByWeightId": True})
    assert chosen(memory, graph, by_id) == [1, 2]


def test_two_leave_and_one_more_for_each_that_came_back() -> None:
    params = params_with()
    memory, graph = walked(14, params)
    for retrieved in ([], [3], [3, 5, 7]):
        left = chosen(memory, graph, params, retrieved=retrieved)
        assert len(left) == len(retrieved) + 2
        assert not set(left) & set(retrieved)


@pytest.mark.parametrize(("room", "leaves"), [(0, False), (7, True), (8, False), (9, False)])
def test_room_is_what_the_parameter_says(room: int, leaves: bool) -> None:
    params = params_with(Rtabmap_MemoryThr=room)
    memory, graph = walked(10, params)  # eight in working memory
    assert bool(chosen(memory, graph, params)) == leaves


@pytest.mark.parametrize(("allowed", "elapsed", "leaves"), [(0, 1e9, False), (50, 49, False), (50, 51, True)])
def test_time_is_what_the_parameter_says(allowed: float, elapsed: float, leaves: bool) -> None:
    params = params_with(Rtabmap_MemoryThr=0, Rtabmap_TimeThr=allowed)
    memory, graph = walked(10, params)
    assert bool(chosen(memory, graph, params, elapsed_ms=elapsed)) == leaves


def test_neighbours_of_short_term_memory_stay() -> None:
    params = params_with(Rtabmap_MemoryThr=1)
    memory, graph = walked(10, params)
    join(graph, 10, 2)  # 10 is in short-term memory; 8 is the neighbour of 9
    assert immunized(memory, graph, 0, 0, params) == {2, 8}
    assert chosen(memory, graph, params, retrieved=[1, 3, 4, 5, 6, 7]) == []


def test_the_last_loop_and_the_newest_after_it_stay() -> None:
    params = params_with(Mem_RecentWmRatio=0.25)
    memory, graph = walked(10, params)
    assert immunized(memory, graph, 0, 0, params) == {7, 8}
    assert immunized(memory, graph, 0, 3, params) == {3, 7, 8}
    assert immunized(memory, graph, 0, 7, params) == {7, 8}


def test_neighbours_in_time_of_the_hypothesis_stay() -> None:
    params = params_with(Rtabmap_MaxRetrieved=1)
    memory, graph = walked(12, params)
    assert immunized(memory, graph, 4, 0, params) == {2, 3, 4, 5, 6, 10}
    memory.transfer([4])
    assert immunized(memory, graph, 4, 0, params) == {10}, "a hypothesis that is not in working memory"


@pytest.mark.parametrize(("radius", "kept"), [(10.0, {1, 2, 4, 8}), (1.5, {1, 4, 8}), (0.5, {8})])
def test_the_closest_stay_within_the_radius(radius: float, kept: set[int]) -> None:
    params = params_with(RGBD_LocalImmunizationRatio=0.5, RGBD_LocalRadius=radius)
    memory, graph = walked(10, params)
    graph.poses[10] = at(0.0)  # the robot is back where it began: 1 is 1 m away, 2 is 2 m
    join(graph, 1, 4)
    join(graph, 4, 8)  # the way from 1 to the robot leads over 4 and 8
    assert immunized(memory, graph, 0, 0, params) == kept


def test_those_on_the_way_from_the_nearest_come_before_the_closest() -> None:
    params = params_with(RGBD_LocalImmunizationRatio=0.4, RGBD_LocalRadius=10.0)
    memory, graph = walked(10, params)
    graph.poses[10] = at(0.0)
    found = Immunity.of(memory, graph, graph, 0, 0, params)
    assert (found.locally, found.most_locally) == ({1, 2, 3}, 3), "no loop: the way back leads over all"
    join(graph, 1, 6)
    join(graph, 6, 9)
    found = Immunity.of(memory, graph, graph, 0, 0, params)
    assert found.locally == {1, 6, 2}
    assert found.lately == {8, 6}
    assert found.globally == set()


@settings(max_examples=60, deadline=None)
@given(
    count=st.integers(4, 25),
    weights=st.dictionaries(st.integers(1, 25), st.integers(0, 4)),
    recent=st.floats(0, 1),
    local=st.floats(0, 1),
    room=st.integers(0, 20),
    retrieved=st.sets(st.integers(1, 25), max_size=4),
    best=st.integers(0, 25),
    last=st.integers(0, 25),
)
def test_those_immunised_or_just_back_never_leave(
    count: int,
    weights: dict[int, int],
    recent: float,
    local: float,
    room: int,
    retrieved: set[int],
    best: int,
    last: int,
) -> None:
    params = params_with(
        Mem_RecentWmRatio=recent, RGBD_LocalImmunizationRatio=local, RGBD_LocalRadius=3.0, Rtabmap_MemoryThr=room
    )
    memory, graph = walked(count, params)
    memory.weights.update({i: w for i, w in weights.items() if i <= count})
    back = sorted(retrieved & memory.wm.keys())
    left = chosen(memory, graph, params, retrieved=back, best_id=best if best <= count else 0, last_loop_id=last)
    kept = immunized(memory, graph, best if best <= count else 0, last, params)
    free = memory.wm.keys() - kept - set(back)
    assert set(left) <= free
    assert len(left) == (min(len(free), len(back) + 2) if 0 < room < len(memory.wm) else 0)
    keys = [(memory.weights[i], memory.wm[i], i) for i in left]
    assert keys == sorted(keys)
    assert all(key <= (memory.weights[i], memory.wm[i], i) for key in keys for i in free - set(left))


@pytest.mark.parametrize("room", [1, 4, 9])
def test_working_memory_stays_within_its_room_over_a_long_walk(room: int) -> None:
    params = params_with(Rtabmap_MemoryThr=room)
    memory, graph = Memory(RamMemory(), seed=0), PoseGraph()
    for node_id in range(1, 40):
        add_place(memory, graph, random_descriptors(3, node_id), params, pose=at(float(node_id)))
        memory.transfer(chosen(memory, graph, params))
        assert len(memory.wm) <= room
    assert len(memory.wm) >= room - 2
