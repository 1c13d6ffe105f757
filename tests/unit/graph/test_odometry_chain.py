"""Odometry's own word about two nodes: the steps put together, with their errors."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import adjoint, between, inverse
from slam.graph import PoseGraph
from slam.graph.odometry_chain import OdometryChain
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles


def stepwise(graph: PoseGraph, first: int, last: int) -> np.ndarray:
    """Covariance at ``last`` of walking there from ``first``, one step after the other."""
    covariance = np.zeros((6, 6))
    for i in range(first, last):
        T_step = graph.links[i, i + 1].T_from_to
        assert T_step is not None
        Ad = adjoint(inverse(T_step))
        covariance = Ad @ covariance @ Ad.T + np.linalg.inv(graph.links[i, i + 1].information)
    return covariance


@pytest.mark.parametrize(("first", "last"), [(1, 2), (7, 30), (12, 60)])
def test_a_stretch_is_its_steps_one_after_the_other(first: int, last: int) -> None:
    graph = circles(60, 3)
    there = OdometryChain(graph).relative([first], [last])
    np.testing.assert_allclose(there.T_a_b[0], between(graph.T_odom[first], graph.T_odom[last]), atol=1e-12)
    np.testing.assert_allclose(there.covariance[0], stepwise(graph, first, last), rtol=1e-9, atol=1e-12)
    assert there.known.all()


def test_the_way_back_is_the_inverse_and_as_sure() -> None:
    chain = OdometryChain(circles(60, 3))
    there, back = chain.relative([7], [30]), chain.relative([30], [7])
    np.testing.assert_allclose(there.T_a_b[0] @ back.T_a_b[0], np.eye(4), atol=1e-12)
    Ad = adjoint(there.T_a_b[0])
    np.testing.assert_allclose(back.covariance[0], Ad @ there.covariance[0] @ Ad.T, rtol=1e-9, atol=1e-12)


def test_loops_and_gaps_are_no_way() -> None:
    graph = circles(60, 6)
    graph.remove_link((30, 31))
    found = OdometryChain(graph).relative([3, 3, 31], [29, 40, 60])
    assert found.known.tolist() == [True, False, True]
    np.testing.assert_array_equal(found.T_a_b[1], np.eye(4))


def test_a_node_that_was_reduced_away_is_bridged() -> None:
    graph = circles(20, 0)
    graph.remove_node(10)
    graph.add_link(Link(11, 9, LinkType.NEIGHBOR_MERGED, between(graph.T_odom[11], graph.T_odom[9]), INFORMATION))
    found = OdometryChain(graph).relative([2], [19])
    assert found.known.all()
    np.testing.assert_allclose(found.T_a_b[0], between(graph.T_odom[2], graph.T_odom[19]), atol=1e-12)


@settings(max_examples=20, deadline=None)
@given(
    joined=st.sets(st.tuples(st.integers(1, 12), st.integers(1, 12)).filter(lambda pair: pair[0] != pair[1])),
    unsound=st.sets(st.integers(0, 40)),
)
def test_each_node_hangs_on_the_nearest_earlier_one_that_a_sound_step_joins_it_with(
    joined: set[tuple[int, int]], unsound: set[int]
) -> None:
    graph, placed = PoseGraph(), circles(12, 0).T_odom
    for node_id, T in placed.items():
        graph.add_node(node_id, 0, T, T)
    steps: dict[int, int] = {}
    for k, (a, b) in enumerate(sorted({(min(pair), max(pair)) for pair in joined})):
        information = np.diag([1.0, 1, 1, 1, 1, np.nan if k % 2 else -1]) if k in unsound else INFORMATION
        graph.add_link(Link(b, a, LinkType.NEIGHBOR, between(placed[b], placed[a]), information))
        if k not in unsound:
            steps[b] = max(a, steps.get(b, 0))
    way = {i: _way(i, steps) for i in placed}
    chain = OdometryChain(graph)
    ends = [(a, b) for a in placed for b in placed]
    found = chain.relative(*np.array(ends).T)
    assert found.known.tolist() == [way[a][-1] == way[b][-1] for a, b in ends]
    expected = [between(placed[a], placed[b]) if way[a][-1] == way[b][-1] else np.eye(4) for a, b in ends]
    np.testing.assert_allclose(found.T_a_b, expected, atol=1e-12)


def _way(node_id: int, steps: dict[int, int]) -> list[int]:
    """The nodes that lead back to where the path of one begins."""
    return [node_id, *_way(steps[node_id], steps)] if node_id in steps else [node_id]
