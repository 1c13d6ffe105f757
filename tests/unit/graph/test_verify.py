"""The RGBD/OptimizeMaxError rule: good loops stay, bad ones leave no trace and say why."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.errors import OptimizationError
from slam.geometry import Pose, between, se3_exp
from slam.graph import PoseGraph, close_loops, max_error, optimize
from slam.graph.verify import residual_ratios
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, LAP, circles, loop, truth

PARAMS = Params()
OFF = PARAMS.changed({"RGBD/OptimizeMaxError": 0})


def moved(link: Link, *twist: float) -> Link:
    assert link.T_from_to is not None
    return replace(link, T_from_to=link.T_from_to @ se3_exp(np.array(twist)))


def good(new: int = 60, old: int = 20, noise: float = 0.5) -> Link:
    return loop(new, old, truth(60), np.random.default_rng(5), noise)


def state(graph: PoseGraph) -> tuple[list[tuple[int, int]], dict[int, list[int]], list[bytes]]:
    neighbors = {i: list(graph.neighbors(i)) for i in graph.poses}
    return list(graph.links), neighbors, [T.tobytes() for T in graph.poses.values()]


def test_a_true_loop_is_kept_and_the_graph_gets_the_poses() -> None:
    graph = circles(noise=0.3)
    closure = close_loops(graph, [good()], PARAMS)
    assert closure.accepted
    assert closure.refusal is None
    assert (20, 60) in graph.links
    assert graph.poses is closure.optimized.poses
    assert closure.worst.ratio < 3


@pytest.mark.parametrize("offset", [(2.0, 0, 0, 0, 0, 0), (0, 0, 0, 0, 0, 0.5)])
def test_a_false_loop_is_refused_with_reason_and_leaves_the_graph_bit_for_bit(offset: tuple[float, ...]) -> None:
    graph = circles(noise=0.3)
    graph.poses = optimize(graph, PARAMS).poses
    before = state(graph)
    closure = close_loops(graph, [good(), moved(good(59, 19), *offset)], PARAMS)
    assert not closure.accepted
    assert state(graph) == before
    refusal = closure.refusal
    assert refusal is not None
    assert (refusal.test, refusal.threshold) == ("RGBD/OptimizeMaxError", 3.0)
    assert refusal.value == closure.worst.ratio > 3
    assert "sigma" in refusal.text
    assert ("linear" in refusal.text) != ("angular" in refusal.text)


def test_zero_switches_the_test_off() -> None:
    graph = circles(noise=0.3)
    closure = close_loops(graph, [moved(good(), 2.0, 0, 0, 0, 0, 0)], OFF)
    assert closure.accepted
    assert closure.worst.ratio > 3


def test_a_link_that_was_bad_before_keeps_no_good_loop_out_and_no_bad_one_in() -> None:
    graph = circles(noise=0.3)
    assert close_loops(graph, [moved(good(25, 5), 0.2, 0, 0, 0, 0, 0)], OFF).worst.ratio > 3
    closure = close_loops(graph, [good()], PARAMS)
    assert closure.accepted
    assert closure.worst.ratio > 3, "it is still told"
    before = state(graph)
    assert not close_loops(graph, [moved(good(59, 19), 0.5, 0, 0, 0, 0, 0)], PARAMS).accepted
    worse = close_loops(graph, [moved(good(26, 6), 0.4, 0, 0, 0, 0, 0)], PARAMS)
    assert not worse.accepted
    assert state(graph) == before


def test_an_error_on_the_way_leaves_the_graph_as_it_was() -> None:
    graph = circles()
    before = state(graph)
    for bad in (good(60, 40), replace(good(), information=np.full((6, 6), np.inf)), replace(good(), to_id=99)):
        with pytest.raises(OptimizationError):
            close_loops(graph, [good(59, 19), bad], PARAMS)
        assert state(graph) == before
    with pytest.raises(OptimizationError, match="at least one"):
        close_loops(graph, [], PARAMS)


@pytest.mark.parametrize("turned", [False, True])
def test_two_sessions_meet_wherever_the_younger_one_started(turned: bool) -> None:
    graph, true = circles(30, 1, noise=0.2), truth(60)
    T_new_map = se3_exp(np.array([5.0, -3.0, 1.0, 0.5, -0.3, 3.0]))
    for i in range(31, 61):
        T = np.asarray(T_new_map @ true[i - 1])
        graph.add_node(i, 1, T, T)
    for i in range(31, 60):
        graph.add_link(Link(i, i + 1, LinkType.NEIGHBOR, between(true[i - 1], true[i]), INFORMATION))
    link = good(60, 20, 0.0)
    if turned:
        link = Link(20, 60, link.type, between(true[19], true[59]), link.information)
    older = graph.poses[1]
    closure = close_loops(graph, [link], PARAMS)
    assert closure.accepted
    assert not closure.optimized.dropped
    assert graph.poses[1] is older
    assert np.allclose(between(graph.poses[20], graph.poses[60]), between(true[19], true[59]), atol=1e-6)


def test_ratios_are_those_of_the_rule() -> None:
    poses: dict[int, Pose] = {1: np.eye(4), 2: se3_exp(np.array([0.0, 0.03, 0.01, 0.0, 0.0, 0.0]))}
    poses[3] = poses[2] @ se3_exp(np.array([0.0, 0, 0, 0, 0, 0.06]))
    information = np.diag([1e4, 2500.0, 1e4, 1e4, 1e4, 2500.0])
    links = [
        Link(1, 2, LinkType.NEIGHBOR, np.eye(4), information),
        Link(2, 3, LinkType.NEIGHBOR, np.eye(4), information),
    ]
    rows = residual_ratios(links, poses)
    assert rows[0] == pytest.approx([0.03 / 0.02, 0.03, 0, 0], abs=1e-9)
    assert rows[1] == pytest.approx([0, 0, 0.06 / 0.02, 0.06], abs=1e-9)


def test_axes_of_unknown_variance_are_not_judged() -> None:
    poses: dict[int, Pose] = {1: np.eye(4), 2: se3_exp(np.array([1.0, 0, 0, 0, 0, 0.5]))}
    unknown = 1 / 9999
    some = Link(1, 2, LinkType.NEIGHBOR, np.eye(4), np.diag([unknown, 100.0, 100.0, unknown, unknown, unknown]))
    linear, metres, angular, radians = residual_ratios([some], poses)[0]
    assert linear == pytest.approx(10 * metres)
    assert (angular, radians) == (0, pytest.approx(0.5))


def test_the_worst_link_is_named_and_whether_it_is_linear_or_angular() -> None:
    graph = circles(LAP, 0, noise=0.0)
    graph.poses[LAP] = graph.poses[LAP] @ se3_exp(np.array([0, 0, 0, 0, 0, 0.1]))
    worst = max_error(graph, graph.poses)
    assert worst.link is graph.links[LAP - 1, LAP]
    assert worst.ratio == worst.angular == pytest.approx(33.3, abs=0.1)
    assert worst.text == f"link {LAP - 1}->{LAP} (Neighbor) is 5.73 deg off, 33.3 sigma of 0.17 deg (angular)"
    graph.poses[LAP] = graph.T_odom[LAP] @ se3_exp(np.array([0, 0, 0.5, 0, 0, 0]))
    text = f"link {LAP - 1}->{LAP} (Neighbor) is 0.500 m off, 50.0 sigma of 0.010 m (linear)"
    assert max_error(graph, graph.poses).text == text
    assert max_error(PoseGraph(), {}).text == "no link"


def test_a_link_that_was_near_the_limit_anyhow_keeps_no_true_loop_out() -> None:
    graph, trial = circles(60, 3, seed=6), circles(60, 3, seed=6)
    graph.poses = optimize(graph, PARAMS).poses
    trial.poses = dict(graph.poses)
    new = loop(50, 30, truth(60), np.random.default_rng(0))
    before = max_error(graph, graph.poses)
    after = close_loops(trial, [new], PARAMS.changed({"RGBD/OptimizeMaxError": 0.0})).worst
    assert before.link is not None and after.link is not None
    assert before.link.pair == after.link.pair != new.pair
    assert 1.1 * before.ratio < after.ratio < 1.15 * before.ratio
    between_both = PARAMS.changed({"RGBD/OptimizeMaxError": 0.5 * (before.ratio + after.ratio)})
    assert close_loops(graph, [new], between_both).accepted
