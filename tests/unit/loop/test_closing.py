"""Closing loops: what agrees stays, what the graph can't live with goes with a reason, and nothing is half done."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slam.geometry import Pose, between, make
from slam.loop.closing import close
from slam.params import Params
from slam.types import Candidate, LinkType, Refusal
from tests.graphs import INFORMATION, LAP, circles, stacked, truth

PARAMS = Params()
WRONG = make(np.eye(3), np.array([1.0, 0.5, 0.0]))


def candidate(new: int, old: int, T_error: Pose | None = None, refusal: Refusal | None = None) -> Candidate:
    """A candidate that measured the truth, or that moved by an error."""
    true = truth(60)
    T_from_to = between(true[new - 1], true[old - 1])
    T_from_to = T_from_to if T_error is None else np.asarray(T_from_to @ T_error)
    return Candidate(new, old, LinkType.GLOBAL_CLOSURE, 0.5, 90, 60, T_from_to, INFORMATION, refusal)


def test_true_loops_are_joined_and_move_the_map() -> None:
    graph = circles(60, 3)
    before = stacked(graph.poses)
    links = len(graph.links)
    tried = [candidate(60, 60 - 2 * LAP), candidate(50, 50 - 2 * LAP)]
    closed = close(graph, tried, PARAMS)
    assert [one.refusal for one in closed.candidates] == [None, None]
    assert [link.pair for link in closed.links] == [(20, 60), (10, 50)]
    assert closed.optimized
    assert len(graph.links) == links + 2
    assert (stacked(graph.poses) != before).any()


def test_a_false_loop_is_refused_and_leaves_no_trace() -> None:
    graph = circles(60, 3)
    before, links = stacked(graph.poses), dict(graph.links)
    closed = close(graph, [candidate(60, 60 - 2 * LAP, WRONG)], PARAMS)
    refusal = closed.candidates[0].refusal
    assert refusal is not None
    assert refusal.test == "RGBD/OptimizeMaxError"
    assert refusal.value > refusal.threshold == 3.0
    assert closed.links == ()
    assert not closed.optimized
    np.testing.assert_array_equal(stacked(graph.poses), before)
    assert graph.links == links


def test_a_true_loop_survives_a_false_one_in_the_same_update() -> None:
    graph = circles(60, 3)
    tried = [candidate(60, 60 - 2 * LAP, WRONG), candidate(60, 19), candidate(60, 45, WRONG)]
    closed = close(graph, tried, PARAMS)
    assert [one.refusal is None for one in closed.candidates] == [False, True, False]
    assert [link.pair for link in closed.links] == [(19, 60)]
    assert closed.optimized
    assert (19, 60) in graph.links
    assert {(20, 60), (45, 60)}.isdisjoint(graph.links)


def test_what_the_images_refused_is_passed_on_untried() -> None:
    graph = circles(60, 3)
    no = Refusal("Vis/MinInliers", 3.0, 20.0, "3 inliers, fewer than Vis/MinInliers 20")
    refused = replace(candidate(60, 20, refusal=no), T_from_to=None, information=None)
    closed = close(graph, [refused], PARAMS)
    assert closed.candidates == (refused,)
    assert closed.closure is None
    mixed = close(graph, [refused, candidate(60, 20)], PARAMS)
    assert [one.refusal for one in mixed.candidates] == [no, None]


def test_without_candidates_nothing_happens() -> None:
    graph = circles(30, 1)
    before = graph.poses
    closed = close(graph, [], PARAMS)
    assert (closed.candidates, closed.links, closed.closure) == ((), (), None)
    assert graph.poses is before


def test_a_loop_that_does_not_fit_the_graph_is_refused_with_what_the_optimiser_said() -> None:
    graph = circles(60, 3)
    before, links = stacked(graph.poses), dict(graph.links)
    closed = close(graph, [candidate(60, 59), candidate(60, 20)], PARAMS)
    refusal = closed.candidates[0].refusal
    assert refusal is not None
    assert refusal.test == "optimization"
    assert "joined by a Neighbor" in refusal.text
    assert closed.candidates[1].refusal is None
    assert [link.pair for link in closed.links] == [(20, 60)]
    assert closed.closure is not None
    graph.remove_link((20, 60))
    assert graph.links == links
    assert (stacked(graph.poses) != before).any()


def test_the_check_can_be_switched_off() -> None:
    graph = circles(60, 3)
    closed = close(graph, [candidate(60, 60 - 2 * LAP, WRONG)], PARAMS.changed({"RGBD/OptimizeMaxError": 0.0}))
    assert closed.candidates[0].refusal is None
