"""Proximity: one place of each path, near enough, facing the same way, not joined already."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.graph.graph import PoseGraph
from slam.loop.proximity import nearby
from slam.params import Params, Value
from slam.types import LinkType
from tests.nodes import at, join

PARAMS = Params()


def changed(**values: Value) -> Params:
    return PARAMS.changed({f"RGBD/{name}": value for name, value in values.items()})


def square(laps: int = 2, side: int = 6) -> PoseGraph:
    """Laps on a square of ``side`` metres, a node each metre, each lap 0.1 m inside the last; facing ahead."""
    graph, node_id = PoseGraph(), 0
    for lap in range(laps):
        for edge in range(4):
            for step in range(side):
                inside = 0.1 * lap
                x, y = float(step), inside
                for _ in range(edge):
                    x, y = side - y, x
                node_id += 1
                graph.add_node(node_id, 0, at(x, y, 90 * edge), at(x, y, 90 * edge))
                if node_id > 1:
                    join(graph, node_id, node_id - 1, LinkType.NEIGHBOR)
    return graph


def near(
    graph: PoseGraph, new: int, params: Params = PARAMS, *, wm: range | None = None, **likelihood: float
) -> list[int]:
    places = range(1, new - 10) if wm is None else wm
    return nearby(new, places, graph, {int(k[1:]): v for k, v in likelihood.items()}, params)


def test_the_node_of_the_last_lap_is_found() -> None:
    assert near(square(), 30) == [6]
    assert near(square(), 27) == [3]


def test_of_a_path_the_likeliest_of_the_close_ones_is_taken() -> None:
    graph = square()
    wide = changed(ProximityPathFilteringRadius=2.5)
    assert near(graph, 28, wide) == [4]
    assert near(graph, 28, wide, n3=2.0, n4=1.0, n5=1.5) == [3]
    assert near(graph, 28, wide, n3=2.0, n4=2.0, n20=9.0) == [4], "equally likely: the nearer"


def test_nodes_farther_than_the_radius_are_no_candidates() -> None:
    graph = square()
    graph.poses[28] = at(3.0, 1.5, 0.0)
    assert near(graph, 28) == []
    assert near(graph, 28, changed(ProximityPathFilteringRadius=1.6)) == [4]


@pytest.mark.parametrize(
    ("turn", "found"), [(0, True), (44, True), (-44, True), (46, False), (-46, False), (180, False)]
)
def test_nodes_that_look_elsewhere_are_no_candidates(turn: float, found: bool) -> None:
    graph = square()
    graph.poses[28] = at(3.0, 0.1, turn)
    assert bool(near(graph, 28)) == found
    assert near(graph, 28, changed(ProximityAngle=180.0)) == [4]


def test_a_path_that_is_joined_already_is_left_alone() -> None:
    graph = square()
    join(graph, 28, 12, LinkType.LOCAL_SPACE_CLOSURE)
    assert near(graph, 28) == []


def test_the_graph_depth_limits() -> None:
    graph = square()
    assert near(graph, 28, changed(ProximityMaxGraphDepth=24)) == [4]
    assert near(graph, 28, changed(ProximityMaxGraphDepth=23)) == []
    assert near(graph, 28, changed(ProximityMaxGraphDepth=0)) == [4]


def test_another_session_is_out_of_reach_until_it_is_joined() -> None:
    graph = square(1)
    graph.add_node(99, 1, at(3.0, 0.1), at(3.0, 0.1))
    for depth in (0, 50):
        assert near(graph, 99, changed(ProximityMaxGraphDepth=depth), wm=range(1, 25)) == []
    join(graph, 99, 15)
    graph.add_node(100, 1, at(3.1, 0.1), at(3.1, 0.1))
    join(graph, 100, 99, LinkType.NEIGHBOR)
    assert near(graph, 100, wm=range(1, 25)) == [4]


def test_one_place_for_each_path_the_likeliest_path_first() -> None:
    graph = square(4)
    # Working memory has holes, so that the laps are three paths.
    wm = [*range(2, 8), *range(26, 32), *range(50, 56)]
    likely = {4: 1.0, 28: 3.0, 52: 2.0}
    for most, expected in ((3, [28, 52, 4]), (2, [28, 52]), (1, [28]), (0, [28, 52, 4])):
        params = changed(ProximityMaxPaths=most, ProximityMaxGraphDepth=0)
        assert nearby(76, wm, graph, likely, params) == expected


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 999), st.floats(0.1, 3), st.floats(1, 180), st.integers(0, 4))
def test_what_is_found_keeps_every_limit(seed: int, radius: float, angle: float, paths: int) -> None:
    rng, graph = np.random.default_rng(seed), PoseGraph()
    for node_id in range(1, 61):
        pose = at(float(rng.uniform(-2, 2)), float(rng.uniform(-2, 2)), float(rng.uniform(0, 360)))
        graph.add_node(node_id, 0, pose, pose)
        if node_id > 1:
            join(graph, node_id, node_id - 1, LinkType.NEIGHBOR)
    wm = sorted(rng.choice(np.arange(1, 50), 30, replace=False).tolist())
    params = changed(
        ProximityPathFilteringRadius=radius, ProximityAngle=angle, ProximityMaxPaths=paths, ProximityMaxGraphDepth=0
    )
    likelihood = {i: float(rng.uniform()) for i in wm}
    found = nearby(60, wm, graph, likelihood, params)
    path_of = np.cumsum([0, *(np.diff(wm) > 1)])
    assert len({path_of[wm.index(i)] for i in found}) == len(found), "one of each path"
    assert len(found) <= (paths or 99)
    for place in found:
        assert np.linalg.norm(graph.poses[place][:3, 3] - graph.poses[60][:3, 3]) <= radius
        cosine = float(graph.poses[place][:3, 0] @ graph.poses[60][:3, 0])
        assert np.degrees(np.arccos(np.clip(cosine, -1, 1))) <= angle + 1e-6
    shuffled = nearby(60, rng.permutation(wm).tolist(), graph, likelihood, params)
    assert shuffled == found, "the order in working memory does not matter"
