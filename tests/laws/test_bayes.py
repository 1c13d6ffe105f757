"""The Bayes filter is a probability, whatever the graph, and follows what it is told."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.errors import ParameterError
from slam.graph.graph import PoseGraph
from slam.loop.bayes import BayesFilter, neighbours_in_time
from slam.loop.transition import Transition
from slam.params import Params
from slam.types import LinkType
from tests.nodes import chain, join

PARAMS = Params()
VALUES = [float(v) for v in PARAMS.Bayes.PredictionLC.split()]
quickly = settings(max_examples=60, deadline=None)
pairs = st.lists(st.tuples(st.integers(1, 25), st.integers(1, 25)), max_size=12)
kinds = st.sampled_from([LinkType.GLOBAL_CLOSURE, LinkType.LOCAL_SPACE_CLOSURE, LinkType.USER_CLOSURE])
predictions = st.sampled_from(
    [PARAMS.Bayes.PredictionLC, "0.1 0.36 0.3 0.16", "0.2 0.8", "0 1", "0.1 0.2 0.1", "0.3 0.1 0.5"]
)


def tangled(count: int, loops: list[tuple[int, int]], kind: LinkType) -> PoseGraph:
    """A chain of ``count`` nodes with loops wherever a pair is in it and not linked yet."""
    graph = chain(count)
    for a, b in loops:
        if max(a, b) <= count and a != b and (min(a, b), max(a, b)) not in graph.links:
            join(graph, max(a, b), min(a, b), kind)
    return graph


def predicting(text: str, stay: float = 0.9) -> Params:
    return PARAMS.changed({"Bayes/PredictionLC": text, "Bayes/VirtualPlacePriorThr": stay})


@quickly
@given(st.integers(1, 25), pairs, kinds, st.sets(st.integers(1, 25)), predictions, st.floats(0, 1))
def test_every_column_of_the_transition_sums_to_one(
    count: int, loops: list[tuple[int, int]], kind: LinkType, gone: set[int], text: str, stay: float
) -> None:
    graph = tangled(count, loops, kind)
    ids = [i for i in range(1, count + 1) if i not in gone]
    matrix = Transition().update(ids, graph, predicting(text, stay))
    assert matrix.shape == (len(ids) + 1, len(ids) + 1)
    assert (matrix >= 0).all()
    np.testing.assert_allclose(matrix.sum(axis=0), 1.0, atol=1e-12)


@quickly
@given(st.integers(1, 20), pairs, kinds, st.integers(0, 999), st.integers(1, 6))
def test_belief_sums_to_one(count: int, loops: list[tuple[int, int]], kind: LinkType, seed: int, steps: int) -> None:
    graph, rng, belief = tangled(count, loops, kind), np.random.default_rng(seed), BayesFilter()
    for _ in range(steps):
        ids = sorted(rng.choice(np.arange(1, count + 1), rng.integers(0, count + 1), replace=False).tolist())
        found = belief.update(ids, rng.uniform(0.5, 10, len(ids)), rng.uniform(1, 3), graph, PARAMS)
        assert found.node_ids.tolist() == ids
        assert (found.probability >= 0).all()
        assert found.probability.sum() + found.virtual_place == pytest.approx(1.0, abs=1e-12)
        assert found.value == pytest.approx(found.probability.sum(), abs=1e-12)


@quickly
@given(st.integers(5, 40), pairs, kinds, st.integers(0, 999), st.integers(1, 6), predictions)
def test_working_out_what_changed_gives_what_working_out_everything_gives(
    count: int, loops: list[tuple[int, int]], kind: LinkType, seed: int, steps: int, text: str
) -> None:
    rng, graph = np.random.default_rng(seed), tangled(count, [], kind)
    params = predicting(text)
    full = params.changed({"Bayes/FullPredictionUpdate": True})
    some, everything = BayesFilter(), BayesFilter()
    left, ids = list(loops), list(range(1, count + 1))
    for _ in range(steps):
        for _ in range(min(2, len(left))):
            a, b = left.pop()
            if max(a, b) <= count and a != b and (min(a, b), max(a, b)) not in graph.links:
                join(graph, max(a, b), min(a, b), kind)
        gone = set(rng.choice(ids, min(3, len(ids) - 1), replace=False).tolist())
        ids = sorted({*(i for i in ids if i not in gone), *rng.integers(1, count + 1, 2).tolist()})
        likelihood = rng.uniform(0.5, 10, len(ids))
        found = some.update(ids, likelihood, 1.5, graph, params)
        best = everything.update(ids, likelihood, 1.5, graph, full)
        np.testing.assert_array_equal(found.probability, best.probability)
        assert found.virtual_place == best.virtual_place


@quickly
@given(st.integers(1, 20), pairs, kinds, st.integers(0, 999))
def test_the_order_of_places_and_links_does_not_matter(
    count: int, loops: list[tuple[int, int]], kind: LinkType, seed: int
) -> None:
    graph, rng = tangled(count, loops, kind), np.random.default_rng(seed)
    other = PoseGraph()
    for i in rng.permutation(np.arange(1, count + 1)).tolist():
        other.add_node(i, 0, graph.T_odom[i], graph.poses[i])
    links = list(graph.links.values())
    for k in rng.permutation(len(links)):
        other.add_link(links[k])
    ids, order = list(range(1, count + 1)), rng.permutation(count)
    straight, mixed = BayesFilter(), BayesFilter()
    for _ in range(3):
        likelihood = rng.uniform(0.5, 10, count)
        a = straight.update(ids, likelihood, 1.5, graph, PARAMS)
        b = mixed.update([ids[k] for k in order], likelihood[order], 1.5, other, PARAMS)
        np.testing.assert_allclose(b.probability, a.probability[order], rtol=1e-9, atol=1e-15)
        assert b.virtual_place == pytest.approx(a.virtual_place, rel=1e-9)


def test_the_transition_of_a_chain_has_the_values_of_the_list() -> None:
    matrix = Transition().update(list(range(1, 42)), chain(41), PARAMS)
    column = matrix[1:, 21]
    total = sum(VALUES) + sum(VALUES[2:]) - VALUES[0]  # neighbours on both sides
    for distance, value in enumerate(VALUES[1:8]):
        expected = value * 0.9 / total
        assert column[20 + distance] == pytest.approx(expected, rel=1e-6)
        assert column[20 - distance] == pytest.approx(expected, rel=1e-6)
    assert matrix[0, 21] == pytest.approx(0.1, rel=1e-6)
    assert (column[[0, 40]] == 0).all(), "farther than the list reaches"


def test_missing_neighbours_leave_their_share_to_the_place_itself() -> None:
    alone = Transition().update([5], chain(9), PARAMS)
    np.testing.assert_allclose(alone, [[0.9, 0.1], [0.1, 0.9]], rtol=1e-6)
    end = Transition().update([1, 2, 3], chain(3), PARAMS)[1:, 1]
    assert end[0] > end[1] > end[2] > 0
    assert end[0] == pytest.approx((sum(VALUES[1:]) - VALUES[2] - VALUES[3]) * 0.9 / sum(VALUES[1:]), rel=1e-6)


def test_places_tied_by_a_loop_are_one_place_and_proximity_ties_nothing() -> None:
    ids = list(range(1, 31))
    tied = Transition().update(ids, tangled(30, [(30, 1)], LinkType.GLOBAL_CLOSURE), PARAMS)
    assert tied[1, 1] >= tied[30, 1] > 1.1 * tied[2, 1]
    assert tied[29, 1] == pytest.approx(tied[2, 1], rel=1e-9), "the neighbours of both are as near"
    near = Transition().update(ids, tangled(30, [(30, 1)], LinkType.LOCAL_SPACE_CLOSURE), PARAMS)
    np.testing.assert_array_equal(near, Transition().update(ids, chain(30), PARAMS))


def test_the_shorter_way_counts() -> None:
    # From 1 by the loop 1-4 to 3 it is one step, along the chain two.
    matrix = Transition().update([1, 2, 3, 4, 5], tangled(5, [(4, 1)], LinkType.GLOBAL_CLOSURE), PARAMS)
    assert matrix[3, 1] == pytest.approx(matrix[2, 1], rel=1e-9)


def test_a_list_below_one_spreads_the_rest_over_the_others() -> None:
    column = Transition().update([1, 2, 3, 4, 5], chain(5), predicting("0.05 0.5 0.05"))[:, 3]
    np.testing.assert_allclose(column, [0.05, *(np.array([0.1, 0.05, 0.5, 0.05, 0.1]) * 0.95 / 0.8)])


def test_a_share_below_the_least_value_goes_to_the_virtual_place() -> None:
    column = Transition().update(list(range(1, 12)), chain(11), predicting("0.1 0.3 0.1"))[:, 6]
    assert (column[[1, 2, 3, 4, 8, 9, 10, 11]] == 0).all()  # half of it over ten places is too little for each
    assert column[0] == pytest.approx(1 - column[5:8].sum())
    assert column[6] == pytest.approx(0.3 * 0.9 / 0.9)


def test_the_virtual_place_stays_or_goes_anywhere() -> None:
    matrix = Transition().update([1, 2, 3, 4], chain(4), predicting(PARAMS.Bayes.PredictionLC, 0.6))
    np.testing.assert_allclose(matrix[:, 0], [0.6, 0.1, 0.1, 0.1, 0.1])
    assert Transition().update([], chain(1), PARAMS).tolist() == [[1.0]]


def test_all_start_equal_and_a_new_place_starts_at_nothing() -> None:
    belief, graph = BayesFilter(), chain(5)
    first = belief.update([1, 2], np.ones(2), 1.0, graph, PARAMS)
    expected = Transition().update([1, 2], graph, PARAMS) @ np.full(3, 1 / 3)
    np.testing.assert_allclose([first.virtual_place, *first.probability], expected)
    second = belief.update([1, 2, 3], np.ones(3), 1.0, graph, PARAMS)
    expected = Transition().update([1, 2, 3], graph, PARAMS) @ [first.virtual_place, *first.probability, 0.0]
    np.testing.assert_allclose([second.virtual_place, *second.probability], expected / expected.sum())


def test_a_place_seen_again_and_again_is_believed_more_and_more() -> None:
    belief, graph, ids = BayesFilter(), chain(20), list(range(1, 21))
    values = [belief.update(ids, np.ones(20), 3.0, graph, PARAMS).value for _ in range(6)][-1:]
    for step in range(5):
        likelihood = np.ones(20)
        likelihood[8 + step] = 6.0  # the robot walks on from place 9
        found = belief.update(ids, likelihood, 1.5, graph, PARAMS)
        values.append(found.value)
        assert found.best_id == 9 + step
    assert values == sorted(values)
    assert values[0] < PARAMS.Rtabmap.LoopThr < 0.3 < values[-1]


def test_what_stands_out_nowhere_is_a_new_place() -> None:
    belief, graph, ids = BayesFilter(), chain(20), list(range(1, 21))
    values = [belief.update(ids, np.ones(20), 3.0, graph, PARAMS).value for _ in range(6)]
    assert values == sorted(values, reverse=True)
    assert values[-1] < PARAMS.Rtabmap.LoopThr


@pytest.mark.parametrize(
    "text", ["", "0.9", "0.1 x 0.2", "0.1 -0.2", "0.1 1.2", "1 0.5 0", "0.1 0 0", "0.1 nan", "0.1 inf"]
)
def test_a_list_that_is_no_transition_is_refused(text: str) -> None:
    with pytest.raises(ParameterError, match="Bayes/PredictionLC"):
        predicting(text)


def test_neighbours_in_time_follow_odometry_only() -> None:
    graph = tangled(10, [(10, 1)], LinkType.GLOBAL_CLOSURE)
    assert neighbours_in_time(1, graph, 2) == {1, 2, 3}
    assert neighbours_in_time(5, graph, 1) == {4, 5, 6}
