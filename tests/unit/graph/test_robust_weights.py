"""GNC takes the weight from loops that the rest of the graph contradicts, and from no other."""

from __future__ import annotations

import numpy as np
import pytest

from slam.graph.optimizer import optimize
from slam.graph.robust_weights import loop_weights
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles, stacked

PARAMS = Params()


@pytest.mark.parametrize("seed", [0, 3])
def test_false_loops_lose_their_weight_even_where_the_map_is_bent_by_them(seed: int) -> None:
    graph, false = circles(60, 12, seed=seed), {(5, 20), (30, 45)}
    for old, new in false:
        graph.add_link(Link(new, old, LinkType.GLOBAL_CLOSURE, np.eye(4), INFORMATION))
    graph.poses = optimize(graph, PARAMS).poses
    before = stacked(graph.poses)
    weights = loop_weights(graph, PARAMS)
    assert {pair for pair, weight in weights.items() if weight < 0.5} == false
    assert weights.keys() == {pair for pair, link in graph.links.items() if link.type.is_loop}
    assert np.array_equal(stacked(graph.poses), before)


def test_each_part_of_a_graph_is_weighed_and_one_without_loops_has_no_weights() -> None:
    graph = circles(60, 12)
    for pair in list(graph.links):
        if pair[0] <= 30 < pair[1]:
            graph.remove_link(pair)
    graph.add_link(Link(10, 3, LinkType.GLOBAL_CLOSURE, np.eye(4), INFORMATION))
    graph.add_link(Link(50, 43, LinkType.GLOBAL_CLOSURE, np.eye(4), INFORMATION))
    assert {(3, 10), (43, 50)} <= loop_weights(graph, PARAMS).keys()
    plain = circles(30, 1)
    for pair in [pair for pair, link in plain.links.items() if link.type.is_loop]:
        plain.remove_link(pair)
    assert loop_weights(plain, PARAMS) == {}
