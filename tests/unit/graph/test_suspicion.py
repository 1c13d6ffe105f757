"""False loops come first, whatever the optimiser made of the map, and true ones are not suspect."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import between
from slam.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.suspicion import suspicions
from slam.params import Params
from slam.types import Link, LinkType
from tests.bench.planting import maps, plantings
from tests.graphs import INFORMATION, LAP, circles, truth


def loops_of(graph: PoseGraph) -> list[Link]:
    return [graph.links[pair] for pair in sorted(graph.links) if graph.links[pair].type.is_loop]


def planted(graph: PoseGraph, *pairs: tuple[int, int]) -> PoseGraph:
    """The graph with false loops that say that two nodes are one place, bent by them."""
    for old, new in pairs:
        graph.add_link(Link(new, old, LinkType.GLOBAL_CLOSURE, np.eye(4), INFORMATION))
    graph.poses = optimize(graph, Params()).poses
    return graph


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000), first=st.integers(1, 15), second=st.integers(60, 80))
def test_planted_loops_are_on_top_and_true_ones_are_not_suspect(seed: int, first: int, second: int) -> None:
    graph = circles(100, 20, seed=seed)
    graph.poses = optimize(graph, Params()).poses
    before = suspicions(graph, loops_of(graph))
    assert max(found.score for found in before.values()) < 1.0
    false = {(first, first + 15), (second, second + 15)}
    found = suspicions(planted(graph, *false), loops_of(graph))
    ranked = sorted(found, key=lambda pair: -found[pair].score)
    assert set(ranked[:2]) == false
    assert all(found[pair].score > 3.0 and found[pair].agreeing == 0 for pair in false)


def test_in_a_map_of_two_thousand_nodes_too() -> None:
    graph = planted(circles(2000, 300), (500, 515), (1200, 1215))
    found = suspicions(graph, loops_of(graph))
    assert set(sorted(found, key=lambda pair: -found[pair].score)[:2]) == {(500, 515), (1200, 1215)}


def test_true_loops_that_false_ones_bend_do_not_hide_them() -> None:
    assert all(one.found and one.mended_m < 0.001 for one in plantings(circles(400, 60), Params(), 8))


def test_planted_loops_are_found_in_a_map_of_rtabmap(shared_data: Path) -> None:
    graph, params = maps(shared_data)["toyroom of C++ RTAB-Map"]()
    assert all(one.found and one.mended_m < 0.001 for one in plantings(graph, params, 8))


def test_covariances_that_are_all_too_small_make_no_loop_suspect() -> None:
    graph = circles(100, 20, noise=4.0)
    graph.poses = optimize(graph, Params()).poses
    found = suspicions(graph, loops_of(graph), Params().changed({"RGBD/OptimizeMaxError": 12.0}))
    assert max(one.score for one in found.values()) < 1.0


def test_a_loop_that_is_not_in_the_graph_is_judged_by_odometry_and_the_others() -> None:
    graph, true = circles(100, 20), truth(100)
    right = Link(72, 72 - LAP, LinkType.GLOBAL_CLOSURE, between(true[71], true[71 - LAP]), INFORMATION)
    wrong = Link(71, 60, LinkType.GLOBAL_CLOSURE, between(true[70], true[70 - LAP]), INFORMATION)
    assert right.pair not in graph.links
    found = suspicions(graph, [right, wrong])
    assert np.isnan(found[right.pair].residual)
    assert found[right.pair].score < 1.0 < 3.0 < found[wrong.pair].score


def test_between_sessions_only_the_other_loops_can_tell() -> None:
    graph = circles(60, 12)
    graph.remove_link((30, 31))
    across = [link for link in loops_of(graph) if link.pair[0] <= 30 < link.pair[1]]
    found = suspicions(graph, across)
    assert across
    assert all(np.isnan(one.odometry) and np.isfinite(one.neighbors) for one in found.values())


def test_without_loops_there_is_nothing_to_say() -> None:
    assert suspicions(circles(20, 0), []) == {}
