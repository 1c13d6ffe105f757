"""The surroundings of a node: so many nodes, in RAM or not, fitted by real links to what lies around them and stays."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.graph.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.memory.active_graph import ActiveGraph
from slam.memory.window import window
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import circles
from tests.nodes import at, chain, join


def solved(nodes: int, loops: int, seed: int) -> PoseGraph:
    """Circles at the optimum of all their links."""
    graph = circles(nodes, loops, seed=seed)
    graph.poses = optimize(graph, Params()).poses
    return graph


@settings(max_examples=20)
@given(seed=st.integers(0, 1000), middle=st.integers(1, 80), size=st.integers(1, 90), data=st.data())
def test_it_holds_what_lies_around_it_and_has_all_links_of_what_moves(
    seed: int, middle: int, size: int, data: st.DataObject
) -> None:
    whole = circles(80, 12, seed=seed)
    active = ActiveGraph(whole)
    active.leave(data.draw(st.lists(st.sampled_from([i for i in range(1, 81) if i != middle]), unique=True)))
    part = window(whole, active.graph, [middle], size)
    free = part.poses.keys() - part.held
    assert middle in free
    assert len(free) == min(size, 80)
    steps = whole.within(middle, 80)
    assert max(steps[i] for i in free) <= min((steps[i] for i in part.held), default=80)
    assert all(part.neighbors(i) == whole.neighbors(i) for i in free)
    assert all(set(pair) & free for pair in part.links)
    assert not any(link.type is LinkType.VIRTUAL_CLOSURE for link in part.links.values())


@settings(max_examples=6)
@given(seed=st.integers(0, 1000), middle=st.integers(1, 80))
def test_at_the_optimum_of_all_a_part_stays_and_goes_back_there(seed: int, middle: int) -> None:
    whole = solved(80, 12, seed)
    part = window(whole, whole, [middle], 15)
    rng = np.random.default_rng(seed)
    expected = dict(part.poses)
    for i in part.poses.keys() - part.held:
        part.poses[i] = part.poses[i] @ at(*rng.normal(0, 0.05, 2), yaw_deg=rng.normal(0, 2))
    found = optimize(part, Params()).poses
    for i, T in expected.items():
        if i in part.held:
            assert found[i] is T, "what is held stays to the last bit"
        np.testing.assert_allclose(found[i], T, atol=2e-3)


def test_a_link_that_was_taken_out_in_ram_is_in_no_window() -> None:
    whole = chain(12)
    join(whole, 12, 1)
    active = ActiveGraph(whole)
    active.leave([4, 5])
    assert (1, 12) in window(whole, active.graph, [12], 6).links
    active.graph.remove_link((1, 12))
    assert (1, 12) not in window(whole, active.graph, [12], 6).links


def test_gravity_of_what_moves_and_landmarks_that_the_rim_sees_are_in_it() -> None:
    whole = chain(12)
    for i in (5, 8, 11):
        whole.add_constraint(Link(i, i, LinkType.GRAVITY, np.eye(4), np.eye(6)))
        whole.add_constraint(Link(i, -1, LinkType.LANDMARK, at(1.0), np.eye(6)))
    part = window(whole, whole, [6], 3)
    assert part.held == {4, 8}
    assert {key[:2] for key in part.constraints} == {(5, 5), (5, -1), (8, -1)}
