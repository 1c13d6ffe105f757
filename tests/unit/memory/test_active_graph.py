"""The graph of what is in RAM: small, in agreement with the whole one, and whole again when everything is back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import between, rotation_angle, translation_norm
from slam.graph.optimizer import optimize
from slam.graph.verify import max_error
from slam.memory.active_graph import ActiveGraph
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles, loop, truth
from tests.nodes import at, chain, join


def apart(active: ActiveGraph) -> float:
    """Largest difference of a pose in RAM between both graphs."""
    pairs = ((active.graph.poses[i], active.whole.poses[i]) for i in active.graph.poses)
    return max(np.abs(a - b).max() for a, b in pairs)


def test_with_everything_in_ram_it_is_the_whole_graph() -> None:
    whole = chain(5)
    active = ActiveGraph(whole)
    assert active.graph is whole
    active.add_node(6, 0, at(5.0), at(5.0))
    assert 6 in whole


def test_a_way_over_nodes_that_left_is_as_long_and_as_sure() -> None:
    active = ActiveGraph(chain(6, spacing=2.0))
    active.leave([3, 4, 2])
    assert set(active.graph.poses) == {1, 5, 6}
    link = active.graph.links[1, 5]
    assert link.type is LinkType.VIRTUAL_CLOSURE
    assert link.T_from_to is not None
    np.testing.assert_allclose(link.T_from_to if link.from_id == 1 else np.linalg.inv(link.T_from_to), at(8.0))
    np.testing.assert_allclose(np.linalg.inv(link.information)[0, 0], 4e-4, rtol=1e-6)
    assert np.linalg.inv(link.information)[1, 1] > 4e-4, "a turn on the way is a sidestep at the end"
    assert len(active.whole) == 6


def test_nodes_that_left_move_with_their_neighbours() -> None:
    active = ActiveGraph(chain(6))
    active.leave([2, 3])
    moved = {i: at(0.0, 5.0) @ T for i, T in active.graph.poses.items()}
    active.graph.poses = moved
    active.closed([])
    assert active.take_moved() == {2, 3}
    assert not active.take_moved()
    for i, T in chain(6).poses.items():
        np.testing.assert_allclose(active.whole.poses[i], at(0.0, 5.0) @ T, atol=1e-12)


def test_a_loop_closed_on_the_small_graph_is_in_the_whole_one() -> None:
    active = ActiveGraph(chain(8))
    active.leave([3, 4, 5])
    link = Link(8, 1, LinkType.GLOBAL_CLOSURE, between(at(7.0), at(0.0)), INFORMATION)
    active.graph.add_link(link)
    active.closed([link])
    assert active.whole.links[1, 8] is link


@settings(max_examples=25)
@given(seed=st.integers(0, 1000), data=st.data())
def test_what_comes_back_in_reverse_order_restores_the_graph(seed: int, data: st.DataObject) -> None:
    whole = circles(40, 5, seed=seed)
    active = ActiveGraph(whole)
    links = dict(whole.links)
    gone = data.draw(st.lists(st.integers(1, 40), unique=True, max_size=30))
    active.leave(gone)
    assert set(active.graph.poses) == set(range(1, 41)) - set(gone)
    assert len(active.graph.links) <= len(links)
    if active.graph.poses:
        assert active.graph.component(min(active.graph.poses)) == set(active.graph.poses), (
            "what hung together still does"
        )
    active.come_back(gone[::-1])
    assert active.graph.links == links
    assert apart(active) < 1e-9


@settings(max_examples=25)
@given(seed=st.integers(0, 1000), data=st.data())
def test_in_any_order_nothing_falls_apart_and_poses_agree(seed: int, data: st.DataObject) -> None:
    whole = circles(40, 5, seed=seed)
    active, away = ActiveGraph(whole), list[int]()
    for _ in range(30):
        ids = data.draw(st.sampled_from([i for i in range(1, 41) if i not in away]))
        active.leave([ids])
        away.append(ids)
        if len(away) > 20:
            active.come_back([away.pop(data.draw(st.integers(0, len(away) - 1)))])
        assert set(active.graph.poses) == set(range(1, 41)) - set(away)
        assert active.graph.component(min(active.graph.poses)) == set(active.graph.poses)
        assert apart(active) < 1e-9


def test_two_that_came_back_amid_absent_nodes_are_still_joined_with_the_rest() -> None:
    active = ActiveGraph(circles(40, 5, seed=0))
    active.leave([1, 6, 7, 8, 4, 2, 3, 5, *range(9, 22)])
    for i in (1, 2, 3, 20):
        active.come_back([i])
        assert active.graph.component(i) == set(active.graph.poses)
    active.come_back(range(1, 41))
    assert active.graph.links == active.whole.links


def test_the_small_graph_is_solved_like_the_whole_one() -> None:
    whole = circles(200, 20, seed=3)
    expected = whole.poses = optimize(whole, Params()).poses
    active = ActiveGraph(whole)
    gone = [i for i in range(2, 201) if i % 3]
    active.leave(gone)
    active.graph.poses = optimize(active.graph, Params()).poses
    active.closed([])
    for i in range(1, 201):
        T = between(expected[i], active.whole.poses[i])
        assert translation_norm(T) < 0.01
        assert rotation_angle(T) < 0.005
    drift = max(translation_norm(between(expected[i], whole.T_odom[i])) for i in expected)
    assert drift > 0.2, "odometry alone is much farther off"


def test_a_node_whose_neighbours_are_all_away_is_tied_to_the_nearest() -> None:
    active = ActiveGraph(chain(7))
    active.leave([2, 3, 4, 5, 6])
    active.come_back([4])
    assert active.graph.component(4) == {1, 4, 7}


def test_decisions_of_people_make_it_anew() -> None:
    whole = chain(7)
    active = ActiveGraph(whole)
    active.leave([3, 4])
    whole.poses = {i: at(0.0, 1.0) @ T for i, T in whole.poses.items()}
    join(whole, 7, 1)
    active.restrict([3, 4])
    assert (1, 7) in active.graph.links
    assert apart(active) == 0.0


def test_a_way_that_is_bent_bends_what_left_of_it_evenly() -> None:
    active = ActiveGraph(chain(11))
    active.leave(range(2, 11))
    far = at(10.0, 2.0)
    active.graph.poses = {1: active.graph.poses[1], 11: far}
    active.closed([])
    sideways = [float(active.whole.poses[i][1, 3]) for i in range(1, 12)]
    np.testing.assert_allclose(sideways, np.linspace(0.0, 2.0, 11), atol=0.15)


@settings(max_examples=15)
@given(seed=st.integers(0, 1000), data=st.data())
def test_a_graph_that_moves_as_one_takes_along_all_that_left(seed: int, data: st.DataObject) -> None:
    whole = circles(40, 5, seed=seed)
    whole.poses = optimize(whole, Params()).poses
    before = dict(whole.poses)
    active = ActiveGraph(whole)
    active.leave(data.draw(st.permutations(range(2, 41)))[:35])
    T = at(3.0, -2.0)
    active.graph.poses = {i: T @ pose for i, pose in active.graph.poses.items()}
    active.closed([])
    for i, pose in before.items():
        np.testing.assert_allclose(active.whole.poses[i], T @ pose, atol=1e-9)


def test_a_loop_that_fits_moves_what_is_around_it_and_nothing_else() -> None:
    whole = circles(300, 200, seed=1)
    whole.poses = optimize(whole, Params()).poses
    active, before = ActiveGraph(whole), dict(whole.poses)
    active.leave([i for i in range(2, 280) if i % 9])
    link = loop(300, 180, truth(300), np.random.default_rng(5))
    closure = active.try_loops(active.graph, [link], Params())
    active.closed([link])
    assert closure.accepted
    assert active.whole.links[180, 300] is link is active.graph.links[180, 300]
    moved = {i for i, T in before.items() if not np.array_equal(T, active.whole.poses[i])}
    assert {180, 300} <= moved
    assert len(moved) <= 160
    assert active.take_moved() == {i for i in moved if i not in active.graph}
    assert max_error(active.whole, active.whole.poses).ratio < Params().RGBD.OptimizeMaxError + 1.0
    assert apart(active) == 0.0


@settings(max_examples=6)
@given(seed=st.integers(0, 1000), off_m=st.sampled_from([0.15, 1.0, 30.0]))
def test_a_false_loop_is_refused_and_leaves_no_trace(seed: int, off_m: float) -> None:
    whole = circles(300, 200, seed=seed)
    whole.poses = optimize(whole, Params()).poses
    active, before = ActiveGraph(whole), dict(whole.poses)
    active.leave([i for i in range(2, 280) if i % 9])
    links = dict(active.graph.links)
    true = loop(300, 180, truth(300), np.random.default_rng(seed))
    assert true.T_from_to is not None
    closure = active.try_loops(active.graph, [replace(true, T_from_to=true.T_from_to @ at(0.0, off_m))], Params())
    assert closure.refusal is not None
    assert closure.refusal.test == "RGBD/OptimizeMaxError"
    assert closure.refusal.value > Params().RGBD.OptimizeMaxError
    assert active.graph.links.keys() == links.keys()
    for i, T in before.items():
        np.testing.assert_allclose(active.whole.poses[i], T, atol=1e-3)


def test_a_loop_that_leads_far_beyond_bends_all_and_what_is_away_follows() -> None:
    active = ActiveGraph(chain(400))
    active.leave([i for i in range(2, 390) if i % 7])
    link = Link(400, 1, LinkType.GLOBAL_CLOSURE, at(-397.0), INFORMATION)
    closure = active.try_loops(active.graph, [link], Params())
    active.closed([link])
    assert closure.accepted
    assert len(active.take_moved()) > 300
    assert max_error(active.whole, active.whole.poses).ratio < 1.0, "two metres are little if all bear them"
