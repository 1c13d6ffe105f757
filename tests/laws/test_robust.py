"""False loops bend a map that takes all links for true; robust kernels let them go, and tell which."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.evaluate import absolute_error
from slam.geometry import between, se3_exp
from slam.graph import Optimized, PoseGraph, close_loops, optimize
from slam.params import Params, Value
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles, loop, stacked, truth

PARAMS = Params().changed({"Optimizer/Iterations": 100})
KERNELS = ("DCS", "Cauchy", "GNC")
NODES = 60
few = settings(max_examples=10, deadline=None)
seeds = st.integers(0, 10_000)


def robust(kernel: str, **more: Value) -> Params:
    return PARAMS.changed({"Optimizer/Robust": True, "Optimizer/RobustKernel": kernel, **more})


def planted(graph: PoseGraph, seed: int, count: int = 3) -> set[tuple[int, int]]:
    """Puts in false loops, metres and half a turn off, between pairs that have none."""
    rng, true, found = np.random.default_rng([seed, 1]), truth(NODES), set[tuple[int, int]]()
    while len(found) < count:
        a, b = sorted(int(i) for i in rng.integers(1, NODES + 1, 2))
        if b - a < 5 or (a, b) in graph.links:
            continue
        off = se3_exp(rng.choice([-1.0, 1.0], 6) * rng.uniform([1, 1, 0.5, 0.2, 0.2, 0.5], [3, 3, 2, 0.5, 0.5, 1.5]))
        T = between(true[b - 1], true[a - 1]) @ off
        graph.add_link(Link(b, a, LinkType.GLOBAL_CLOSURE, np.asarray(T), INFORMATION))
        found.add((a, b))
    return found


def named(result: Optimized, false: set[tuple[int, int]]) -> None:
    """All false loops are outliers; of 12 true ones, noisy as they are, one or two may be beyond 99 % by chance."""
    outliers = set(result.outliers)
    assert false <= outliers
    assert len(outliers - false) <= 2


def ate_m(graph: PoseGraph, params: Params) -> float:
    return absolute_error(np.array(truth(NODES)), stacked(optimize(graph, params).poses)).rmse_m


@pytest.mark.parametrize("kernel", KERNELS)
@few
@given(seed=seeds)
def test_robust_kernels_recover_the_path_and_plain_least_squares_does_not(kernel: str, seed: int) -> None:
    graph = circles(NODES, 12, noise=0.7, seed=seed)
    clean = ate_m(graph, PARAMS)
    false = planted(graph, seed)
    assert ate_m(graph, PARAMS) > 5 * clean
    result = optimize(graph, robust(kernel))
    assert absolute_error(np.array(truth(NODES)), stacked(result.poses)).rmse_m < 1.5 * clean + 0.005
    named(result, false)
    assert result.chi2_after < result.chi2_before


@pytest.mark.parametrize("kernel", KERNELS)
@few
@given(seed=seeds)
def test_where_all_loops_are_true_none_is_let_go(kernel: str, seed: int) -> None:
    graph = circles(NODES, 12, noise=0.7, seed=seed)
    result = optimize(graph, robust(kernel))
    assert ate_m(graph, robust(kernel)) < 1.2 * ate_m(graph, PARAMS) + 0.005
    named(result, set())


@few
@given(seed=seeds, kernel=st.sampled_from(["DCS", "Cauchy"]), planar=st.booleans(), method=st.sampled_from([0, 2]))
def test_kernels_work_in_the_plane_and_by_dogleg(seed: int, kernel: str, planar: bool, method: int) -> None:
    graph = circles(NODES, 12, noise=0.7, seed=seed)
    false = planted(graph, seed)
    named(optimize(graph, robust(kernel, **{"GTSAM/Optimizer": method, "Reg/Force3DoF": planar})), false)


def test_a_false_loop_is_refused_and_one_that_is_in_already_keeps_no_true_one_out() -> None:
    graph, params = circles(NODES, 12, noise=0.5), robust("DCS")
    false = planted(graph, 4, 1)
    graph.poses = optimize(graph, params).poses
    rng = np.random.default_rng(5)
    good = loop(NODES - 2, 7, truth(NODES), rng, 0.5)
    closure = close_loops(graph, [good], params)
    assert closure.accepted
    assert set(closure.optimized.outliers) == false
    other = circles(NODES, 12, noise=0.5)
    (pair,) = planted(other, 6, 1)
    wrong = other.remove_link(pair)
    assert not close_loops(graph, [wrong], params).accepted
