"""Pose graph optimisation with GTSAM: what goes in, what comes out, and that it is no worse than it was."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache

from slam.geometry import Pose
from slam.graph.factors import Style, Workshop
from slam.graph.gauge import is_held
from slam.graph.graph import Pair, PoseGraph
from slam.graph.incremental import Incremental
from slam.graph.kernels import Kernel, choose_kernel
from slam.graph.problem import Problem, choose_root
from slam.graph.solvers import Solver, Watch, batch_solver, cost, outlying
from slam.graph.spaces import SPATIAL, choose_space
from slam.graph.start import Starts
from slam.params import Params
from slam.types import Link

#: ``Optimizer/Strategy``, as RTAB-Map numbers them.
_GTSAM = 2


#: Sees the poses of all nodes that are optimised and chi2 after each iteration.
WatchPoses = Callable[[dict[int, Pose], float], None]


@dataclass(frozen=True, slots=True, eq=False)
class Optimized:
    """Outcome of an optimisation.

    Attributes:
        poses: id -> (4, 4) ``T_map_base`` of every node of the graph; those in ``dropped`` are as they were.
        chi2_before: sum of squared, whitened residuals of the links at the start, of loops as a robust kernel has it.
        chi2_after: the same at the end.
        iterations: of the solver.
        seconds: time this took.
        root: id held where it was, as far as neither priors nor gravity say otherwise.
        dropped: ids that nothing joins with the root.
        clamped: number of links whose information had eigenvalues out of bounds.
        fallback: whether the solver asked for took no step, or only led uphill, and another found the way.
        landmarks: negative id -> (4, 4) ``T_map_landmark``.
        outliers: pairs of the loops that a robust kernel took the weight from.
    """

    poses: dict[int, Pose]
    chi2_before: float
    chi2_after: float
    iterations: int
    seconds: float
    root: int
    dropped: tuple[int, ...] = ()
    clamped: int = 0
    fallback: bool = False
    landmarks: dict[int, Pose] = field(default_factory=dict)
    outliers: tuple[Pair, ...] = ()


def optimize(
    graph: PoseGraph, params: Params, *, root: int | None = None, watch: WatchPoses | None = None
) -> Optimized:
    """Poses of least chi2, from the graph's poses; the graph itself stays as it is.

    Args:
        graph: poses to start from, links and constraints.
        params: groups ``Optimizer`` and ``GTSAM``, ``Reg/Force3DoF``, ``RGBD/OptimizeFromGraphEnd``.
        root: id to hold fixed; by default what ``choose_root`` gives for the newest node.
        watch: sees each iteration, of solvers that have any: not of GNC, nor of iSAM2.

    Raises:
        OptimizationError: the graph is empty, a link has no finite values, or the solver finds no way down.
    """
    start = time.perf_counter()
    root = choose_root(graph, params, graph.newest) if root is None else root
    problem = Problem.of(graph, root, params)
    dropped = tuple(sorted(graph.poses.keys() - set(problem.ids)))
    if not problem.measurements:
        return Optimized(dict(graph.poses), 0.0, 0.0, 0, time.perf_counter() - start, root, dropped)
    style = _style(params)
    factors = _workshop().factors(problem, style)
    found = _solver(graph, params, _watched(problem, style, watch)).solve(
        factors, _starts().values(problem, style.space), params
    )
    solved = _starts().poses(problem, style.space, found.values)
    if is_held(problem):
        solved[root] = graph.poses[root] if style.space is SPATIAL else style.space.flat(graph.poses[root][None])[0]
    outliers = outlying(factors, found.values) if style.kernel is not Kernel.NONE else []
    return Optimized(
        poses={i: solved.get(i, T) for i, T in graph.poses.items()},
        chi2_before=found.before,
        chi2_after=found.after,
        iterations=found.iterations,
        seconds=time.perf_counter() - start,
        root=root,
        dropped=dropped,
        clamped=factors.clamped,
        fallback=found.fallback,
        landmarks={i: solved[i] for i in problem.landmark_ids},
        outliers=tuple(problem.links[row].pair for row in outliers),
    )


def _watched(problem: Problem, style: Style, watch: WatchPoses | None) -> Watch | None:
    if watch is None:
        return None
    return lambda values, cost: watch(_starts().poses(problem, style.space, values), cost)


def chi2(links: Sequence[Link], poses: dict[int, Pose]) -> float:
    """Sum of squared, whitened residuals of these links between nodes at these poses."""
    if not links:
        return 0.0
    ids = sorted({i for link in links for i in link.pair})
    problem = Problem(ids[0], ids, links, [], [], [], poses)
    factors = _workshop().factors(problem, Style(SPATIAL, Kernel.NONE))
    return cost(factors.graph(), _starts().values(problem, SPATIAL))


@cache
def _workshop() -> Workshop:
    return Workshop()


@cache
def _starts() -> Starts:
    return Starts()


def _style(params: Params) -> Style:
    sigma = params.Optimizer.GravitySigma
    return Style(choose_space(params), choose_kernel(params), params.Optimizer.VarianceIgnored, sigma)


def _solver(graph: PoseGraph, params: Params, watch: Watch | None) -> Solver:
    """By ``Optimizer/Strategy``."""
    return {_GTSAM: _gtsam_solver}[params.Optimizer.Strategy](graph, params, watch)


def _gtsam_solver(graph: PoseGraph, params: Params, watch: Watch | None) -> Solver:
    """Goes on from the last optimisation where that is asked for; GNC knows no such way."""
    if params.GTSAM.Incremental and choose_kernel(params) is not Kernel.GNC:
        return Incremental(graph, choose_space(params))
    return batch_solver(params) if watch is None else batch_solver(params, watch)


__all__ = ["Optimized", "chi2", "choose_root", "optimize"]
