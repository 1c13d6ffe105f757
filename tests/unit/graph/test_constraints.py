"""Priors, gravity, landmarks and the plane: what they pull and what they leave alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.errors import OptimizationError
from slam.geometry import Pose, between, inverse, make, se3_exp, transform
from slam.graph import PoseGraph, close_loops, optimize
from slam.params import Params, Value
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles, stacked, truth
from tests.nodes import at

TIGHT = Params().changed({"Optimizer/Epsilon": 1e-12, "Optimizer/Iterations": 100})
LEVEL = np.diag([1e-6, 1e-6, 1e-6, 1.0, 1.0, 1.0])
TILT = se3_exp(np.array([0.0, 0, 0, 0.1, -0.2, 0]))


def with_(changes: dict[str, Value]) -> Params:
    return TIGHT.changed(changes)


def gravity(node_id: int, T_map_base: Pose) -> Link:
    return Link(node_id, node_id, LinkType.GRAVITY, make(T_map_base[:3, :3], np.zeros(3)), LEVEL)


def tilted() -> PoseGraph:
    """A graph whose map frame is 13 degrees off, with nodes that know where up is."""
    graph = circles(noise=0.0)
    for node_id, T in zip(graph.poses, truth(len(graph)), strict=True):
        graph.poses[node_id] = TILT @ T
        if node_id % 5 == 0:
            graph.add_constraint(gravity(node_id, T))
    return graph


def test_gravity_rights_a_tilted_map_and_turns_no_heading() -> None:
    graph = tilted()
    result = optimize(graph, with_({"Optimizer/GravitySigma": 0.1}))
    shape, shaped = (inverse(T[0]) @ T for T in (stacked(graph.poses), stacked(result.poses)))
    assert np.allclose(shape, shaped, atol=1e-6), "all links agreed, and still do"
    assert np.allclose(stacked(result.poses)[:, 2, :3], np.array(truth(60))[:, 2, :3], atol=1e-5)
    assert np.allclose(result.poses[1][:3, 3], graph.poses[1][:3, 3], atol=1e-5)
    turned = result.poses[1][:3, :3] @ graph.poses[1][:3, :3].T
    assert abs(turned[1, 0] - turned[0, 1]) < 1e-5, "the shortest way up has no turn about the vertical"


def test_gravity_is_off_at_sigma_zero_and_in_the_plane() -> None:
    graph = tilted()
    off = optimize(graph, with_({"Optimizer/GravitySigma": 0}))
    assert np.allclose(stacked(off.poses), stacked(graph.poses), atol=1e-9)
    assert optimize(graph, with_({"Reg/Force3DoF": True})).chi2_after < 1.0


def test_a_smaller_sigma_pulls_harder() -> None:
    graph = circles(20, 0, noise=0.0)
    graph.add_constraint(gravity(10, graph.poses[10] @ TILT))
    off_level = [
        np.linalg.norm(result.poses[10][2, :3] - (graph.poses[10] @ TILT)[2, :3])
        for sigma in (1.0, 0.1, 0.01)
        for result in [optimize(graph, with_({"Optimizer/GravitySigma": sigma, "Optimizer/PriorsIgnored": True}))]
    ]
    assert off_level[0] >= off_level[1] >= off_level[2]


def prior(node_id: int, T: Pose, *, position_only: bool = False) -> Link:
    information = 1e4 * np.eye(6)
    if position_only:
        information[3:, 3:] = np.eye(3) / 9999.0
    return Link(node_id, node_id, LinkType.POSE_PRIOR, T, information)


def test_a_prior_takes_the_map_along_only_when_it_is_asked_for() -> None:
    graph, T_new_map = circles(noise=0.0), se3_exp(np.array([5.0, -2, 1, 0.3, 0.2, 1.0]))
    graph.add_constraint(prior(30, T_new_map @ graph.poses[30]))
    ignored = optimize(graph, TIGHT)
    assert np.allclose(stacked(ignored.poses), stacked(graph.poses), atol=1e-9)
    moved = optimize(graph, with_({"Optimizer/PriorsIgnored": False}))
    assert np.allclose(stacked(moved.poses), T_new_map @ stacked(graph.poses), atol=1e-4)


def test_priors_of_positions_turn_the_map_into_place_together() -> None:
    graph, T_new_map = circles(noise=0.0), se3_exp(np.array([5.0, -2, 1, 0.3, 0.2, 1.0]))
    wrong = se3_exp(np.array([0, 0, 0, 1.0, 1, 1]))
    for i in (5, 12, 33, 50):
        graph.add_constraint(prior(i, T_new_map @ graph.poses[i] @ wrong, position_only=True))
    moved = optimize(graph, with_({"Optimizer/PriorsIgnored": False}))
    assert np.allclose(stacked(moved.poses), T_new_map @ stacked(graph.poses), atol=1e-3)


def sighting(node_id: int, T_from_landmark: Pose, *, landmark: int = -7, position_only: bool = True) -> Link:
    information = np.diag([2e3, 2e3, 500.0, 2e3, 2e3, 2e3])
    if position_only:
        information[3:, 3:] = np.eye(3) / 9999.0
    return Link(node_id, landmark, LinkType.LANDMARK, T_from_landmark, information)


@pytest.mark.parametrize("position_only", [True, False])
@pytest.mark.parametrize("planar", [False, True])
def test_a_landmark_seen_again_closes_the_loop(position_only: bool, planar: bool) -> None:
    true = [at(0.5 * k, 0.2 * np.sin(k), 5.0 * k) for k in range(30)]
    T_map_landmark, rng, graph = at(4.0, 3.0, 30.0), np.random.default_rng(2), PoseGraph()
    T_odom = true[0]
    graph.add_node(1, 0, T_odom, T_odom)
    for i in range(1, 30):
        step = between(true[i - 1], true[i]) @ at(rng.normal(0, 0.02), 0.02, 0.4)
        T_odom = T_odom @ step
        graph.add_node(i + 1, 0, T_odom, T_odom)
        graph.add_link(Link(i, i + 1, LinkType.NEIGHBOR, step, INFORMATION))
    for i in (2, 3, 15, 28, 29):
        seen = between(true[i - 1], T_map_landmark)
        graph.add_constraint(sighting(i, seen, position_only=position_only))
    params = with_({"Reg/Force3DoF": planar, "Optimizer/LandmarksIgnored": False})
    result = optimize(graph, params)
    error = np.linalg.norm(result.poses[30][:2, 3] - true[29][:2, 3])
    assert error < 0.4 * np.linalg.norm(graph.poses[30][:2, 3] - true[29][:2, 3])
    assert np.linalg.norm(result.landmarks[-7][:3, 3] - T_map_landmark[:3, 3]) < 0.3
    ignored = optimize(graph, with_({"Reg/Force3DoF": planar, "Optimizer/LandmarksIgnored": True}))
    assert ignored.landmarks == {}
    assert np.allclose(ignored.poses[30], graph.poses[30], atol=1e-9)


def test_a_landmark_alone_joins_two_sessions() -> None:
    graph = circles(5, 0, noise=0.0)
    for i in (11, 12):
        graph.add_node(i, 1, at(float(i)), at(float(i)))
    graph.add_link(Link(11, 12, LinkType.NEIGHBOR, at(1.0), INFORMATION))
    for i, seen in ((2, at(1.0, 1.0)), (11, at(-1.0, 1.0, 40.0))):
        graph.add_constraint(sighting(i, seen, position_only=False))
    result = optimize(graph, TIGHT)
    assert (result.root, result.dropped) == (1, ())
    meet = [result.poses[2] @ at(1.0, 1.0), result.poses[11] @ at(-1.0, 1.0, 40.0)]
    assert np.allclose(meet[0], meet[1], atol=1e-5)
    assert optimize(graph, with_({"Optimizer/LandmarksIgnored": True}), root=1).dropped == (11, 12)


def test_a_landmark_where_the_node_is_has_no_direction() -> None:
    graph = circles(5, 0)
    graph.add_constraint(sighting(2, np.eye(4)))
    with pytest.raises(OptimizationError, match=r"2->-7 \(Landmark\): .* no direction"):
        optimize(graph, TIGHT)


def test_the_information_of_a_sighting_counts_along_the_node_s_axes() -> None:
    """A landmark that is far off in height, which the sighting hardly knows, costs as little as the sighting says."""
    graph = circles(2, 0, noise=0.0)
    graph.poses[2] = graph.T_odom[2] = np.eye(4)
    graph.remove_link((1, 2))
    graph.add_link(Link(1, 2, LinkType.NEIGHBOR, np.eye(4), 1e8 * np.eye(6)))
    sure = np.diag([1e2, 1e2, 1.0, 1e-4, 1e-4, 1e-4])
    for i, z in ((1, 0.0), (2, 0.02)):
        graph.add_constraint(replace(sighting(i, make(np.eye(3), np.array([3.0, 1.0, z]))), information=sure))
    along = optimize(graph, TIGHT).chi2_after
    graph.add_constraint(replace(sighting(2, make(np.eye(3), np.array([3.0, 1.02, 0.0]))), information=sure))
    across = optimize(graph, TIGHT).chi2_after
    assert along == pytest.approx(0.5 * 0.02**2, rel=0.05)
    assert across == pytest.approx(0.5 * 100 * 0.02**2, rel=0.05)


def test_constraints_go_with_their_node_and_must_be_some() -> None:
    graph = circles(3, 0)
    graph.add_constraint(prior(3, np.eye(4)))
    graph.add_constraint(gravity(3, np.eye(4)))
    assert len(graph.constraints) == 2
    graph.remove_node(3)
    assert graph.constraints == {}
    for bad in (prior(9, np.eye(4)), sighting(2, np.eye(4), landmark=7), replace(prior(2, np.eye(4)), to_id=1)):
        with pytest.raises(OptimizationError):
            graph.add_constraint(bad)


def test_in_the_plane_height_and_tilt_vanish_and_the_rest_is_optimised() -> None:
    graph = circles(noise=1.0)
    result = optimize(graph, with_({"Reg/Force3DoF": True}))
    T = stacked(result.poses)
    assert np.array_equal(T[:, 2], np.tile([0.0, 0.0, 1.0, 0.0], (60, 1)))
    true = np.array(truth(60))
    drift = np.linalg.norm(stacked(graph.poses)[:, :2, 3] - true[:, :2, 3], axis=1).mean()
    assert np.linalg.norm(T[:, :2, 3] - true[:, :2, 3], axis=1).mean() < drift


def test_in_the_plane_a_loop_is_judged_by_what_it_says_of_the_plane() -> None:
    graph, planar = circles(noise=0.3), with_({"Reg/Force3DoF": True})
    raised = between(truth(60)[59], truth(60)[19])
    raised[2, 3] += 1.0
    assert close_loops(graph, [Link(60, 20, LinkType.GLOBAL_CLOSURE, raised, INFORMATION)], planar).accepted
    aside = between(truth(60)[58], truth(60)[18])
    aside[1, 3] += 1.0
    assert not close_loops(graph, [Link(59, 19, LinkType.GLOBAL_CLOSURE, aside, INFORMATION)], planar).accepted


def test_same_variance_makes_a_heavy_link_one_among_others() -> None:
    graph = PoseGraph()
    for i in (1, 2):
        graph.add_node(i, 0, at(0), at(0))
    graph.add_node(3, 0, at(0), at(0))
    for a, b, x, weight in ((1, 2, 1.0, 1e6), (2, 3, 1.0, 1.0), (1, 3, 0.0, 1.0)):
        graph.add_link(Link(a, b, LinkType.NEIGHBOR, at(x), weight * np.eye(6)))
    weighed = optimize(graph, TIGHT).poses[2][0, 3]
    same = optimize(graph, with_({"Optimizer/VarianceIgnored": True})).poses[2][0, 3]
    assert weighed == pytest.approx(1.0, abs=1e-5)
    assert same == pytest.approx(1 / 3, abs=1e-5)


def test_points_of_the_map_do_not_care_which_end_a_landmark_was_seen_from() -> None:
    graph = circles(noise=0.0)
    point = np.array([[2.0, 1.0, 0.5]])
    for i in (4, 25, 40):
        seen = make(np.eye(3), transform(inverse(graph.poses[i]), point)[0])
        graph.add_constraint(sighting(i, seen))
    assert np.allclose(optimize(graph, TIGHT).landmarks[-7][:3, 3], point[0], atol=1e-6)
