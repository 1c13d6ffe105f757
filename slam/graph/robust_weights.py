"""How much graduated non-convexity (GNC) lets each loop count: a second opinion on the whole graph at once."""

from __future__ import annotations

from slam.graph.factors import Style, Workshop
from slam.graph.graph import Pair, PoseGraph
from slam.graph.kernels import Kernel
from slam.graph.problem import Problem, choose_root
from slam.graph.solvers import GraduatedNonConvexity
from slam.graph.spaces import choose_space
from slam.graph.start import Starts
from slam.params import Params


def loop_weights(graph: PoseGraph, params: Params) -> dict[Pair, float]:
    """Weight in [0, 1] of every loop of a graph: 0 for those that odometry and the other loops contradict.

    It takes tens of seconds on thousands of nodes. All links but loops are taken for true; the graph stays as it is.

    Raises:
        OptimizationError: a link has no finite values, or there is no solution.
    """
    style = Style(choose_space(params), Kernel.GNC, params.Optimizer.VarianceIgnored, params.Optimizer.GravitySigma)
    left = {node_id for pair, link in graph.links.items() if link.type.is_loop for node_id in pair}
    found: dict[Pair, float] = {}
    while left:
        problem = Problem.of(graph, choose_root(graph, params, min(left)), params)
        left -= set(problem.ids)
        factors = Workshop().factors(problem, style)
        weights = GraduatedNonConvexity().weights(factors, Starts().values(problem, style.space), params)
        pairs = [problem.measurements[row].pair for row in factors.loops]
        found |= dict(zip(pairs, weights.tolist(), strict=True))
    return found
