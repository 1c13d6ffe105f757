"""GTSAM's ways to the least squares: one small class each, chosen by parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import gtsam
import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array
from slam.graph.factors import Factors
from slam.graph.kernels import OUTLIER_CHI2, Kernel, choose_kernel
from slam.params import Params

#: A decrease that is promised and not delivered is an error from this share of chi2 on.
_STUCK = 1e-3
#: Decreases of chi2 below this are rounding, whatever ``Optimizer/Epsilon`` says.
_ROUNDING = 1e-10
#: Damping that Levenberg-Marquardt begins with, up to which its steps are those of Gauss-Newton. GTSAM's own 1e-5 is
#: felt in weakly determined directions: parking-garage then takes seven iterations in place of four.
_UNDAMPED = 1e-9
#: Convergence counts as fast from this ratio of one decrease to the one before.
_FAST = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Where a solver ended.

    Attributes:
        values: of all poses and landmarks.
        before: cost at the start.
        after: cost at the end.
        iterations: taken.
        fallback: whether the first try took no step, or went uphill, and another solver found the way.
        uphill: whether it ended before a step that only led up.
    """

    values: gtsam.Values
    before: float
    after: float
    iterations: int
    fallback: bool = False
    uphill: bool = False


class Solver(Protocol):
    """Minimises the cost of factors."""

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """The least cost that is found; raises OptimizationError when there is no way down."""
        ...


#: Sees the poses and the cost after each iteration.
Watch = Callable[[gtsam.Values, float], None]


def _unwatched(values: gtsam.Values, cost: float) -> None:
    del values, cost


class LevenbergMarquardt:
    """Never goes uphill; with Ceres' parameters where its own take no step."""

    def __init__(self, watch: Watch = _unwatched) -> None:
        self._watch = watch

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """By ``Optimizer/Iterations`` and ``Optimizer/Epsilon``."""
        graph, options = factors.graph(), gtsam.LevenbergMarquardtParams()
        options.setlambdaInitial(_UNDAMPED)
        found = _descend(gtsam.LevenbergMarquardtOptimizer(graph, start, options), factors, params, self._watch)
        if went_down(graph, start, found):
            return found
        ceres = gtsam.LevenbergMarquardtParams.CeresDefaults()
        again = _descend(gtsam.LevenbergMarquardtOptimizer(graph, start, ceres), factors, params, self._watch)
        if again.after < again.before:
            return replace(again, fallback=True)
        raise no_way_down(factors, again, "look for links with wrong information")


class GaussNewton:
    """Full steps; before one that goes uphill Levenberg-Marquardt takes over."""

    def __init__(self, watch: Watch = _unwatched) -> None:
        self._watch = watch

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """By ``Optimizer/Iterations`` and ``Optimizer/Epsilon``."""
        return _checked(gtsam.GaussNewtonOptimizer(factors.graph(), start), factors, start, params, self._watch)


class Dogleg:
    """Steps within a trust region; where none leads down Levenberg-Marquardt takes over."""

    def __init__(self, watch: Watch = _unwatched) -> None:
        self._watch = watch

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """By ``Optimizer/Iterations`` and ``Optimizer/Epsilon``."""
        return _checked(gtsam.DoglegOptimizer(factors.graph(), start), factors, start, params, self._watch)


class GraduatedNonConvexity:
    """Yang et al., "Graduated Non-Convexity for Robust Spatial Perception", 2020, with truncated least squares.

    Loops count fully or not at all in the end; the cost of one that is left out is the threshold.
    """

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """All links but loops are taken for true."""
        if not factors.loops:
            return LevenbergMarquardt().solve(factors, start, params)
        graph = factors.graph()
        values, _ = _reweighed(factors, graph, start, params)
        before, after = (_truncated(factors, graph, at) for at in (start, values))
        if after > before * (1.0 + _STUCK):
            # Where all loops are far off, none of them is the better explanation.
            found = Solution(values, before, after, 0)
            raise no_way_down(factors, found, "Optimizer/RobustKernel DCS starts from the poses as they are")
        return Solution(values, before, after, gtsam.GncLMParams().maxIterations)

    def weights(self, factors: Factors, start: gtsam.Values, params: Params) -> Array:
        """Weight (N,) in [0, 1] of each loop, in the order of ``factors.loops``; raises like ``solve``."""
        if not factors.loops:
            return np.zeros(0)
        _, weights = _reweighed(factors, factors.graph(), start, params)
        return weights[factors.loops]


def _reweighed(
    factors: Factors, graph: gtsam.NonlinearFactorGraph, start: gtsam.Values, params: Params
) -> tuple[gtsam.Values, Array]:
    """Where GNC ends, and the weight of every factor."""
    lm = gtsam.LevenbergMarquardtParams()
    lm.setMaxIterations(params.Optimizer.Iterations)
    lm.setRelativeErrorTol(params.Optimizer.Epsilon)
    options = gtsam.GncLMParams(lm)
    options.setLossType(gtsam.GncLossType.TLS)
    options.setKnownInliers(sorted(set(range(len(factors.factors))) - set(factors.loops)))
    try:
        solver = gtsam.GncLMOptimizer(graph, start, options)
        return gtsam.Values(solver.optimize()), np.array(solver.getWeights())
    except RuntimeError as error:
        raise unsolvable(factors, error) from error


def batch_solver(params: Params, watch: Watch = _unwatched) -> Solver:
    """The solver of a whole problem that ``GTSAM/Optimizer`` and the kernel ask for; GNC has no steps to watch."""
    if choose_kernel(params) is Kernel.GNC:
        return GraduatedNonConvexity()
    return (LevenbergMarquardt, GaussNewton, Dogleg)[params.GTSAM.Optimizer](watch)


def cost(graph: gtsam.NonlinearFactorGraph, at: gtsam.Values) -> float:
    """Sum of squared, whitened residuals, of loops as the kernel has it."""
    return float(2.0 * graph.error(at))


def outlying(factors: Factors, at: gtsam.Values) -> list[int]:
    """Rows of the loops whose chi2 hardly any true measurement has."""
    found = []
    for row in factors.loops:
        residual = _whitened(factors.factors[row], at)
        if residual @ residual > OUTLIER_CHI2[len(residual)]:
            found.append(row)
    return found


def at_minimum(graph: gtsam.NonlinearFactorGraph, at: gtsam.Values, before: float) -> bool:
    """Whether even the linearised problem promises no decrease worth the name."""
    if before < 1e-9:
        return True
    linear = graph.linearize(at)
    try:
        promised = 2.0 * linear.error(linear.optimize())
    except RuntimeError:
        return False
    return before - promised <= _STUCK * before


def went_down(graph: gtsam.NonlinearFactorGraph, start: gtsam.Values, found: Solution) -> bool:
    """Whether a solution is better than its start, or the start could not be bettered."""
    return found.after < found.before or at_minimum(graph, start, found.before)


def no_way_down(factors: Factors, found: Solution, advice: str) -> OptimizationError:
    """The error of a solver that ended no lower than it began."""
    return OptimizationError(
        f"the optimiser finds no way down from chi2 {found.before:.6g} ({len(factors.factors) - 1} links, "
        f"{found.iterations} iterations end at {found.after:.6g}); {advice}"
    )


def unsolvable(factors: Factors, error: RuntimeError) -> OptimizationError:
    """GTSAM's own error, in one line."""
    return OptimizationError(f"GTSAM can't solve {len(factors.factors) - 1} links: {str(error).strip()}")


def _checked(
    solver: gtsam.NonlinearOptimizer, factors: Factors, start: gtsam.Values, params: Params, watch: Watch
) -> Solution:
    """For solvers that may go uphill, which happens far from the minimum, as after a false loop was taken out."""
    found = _descend(solver, factors, params, watch)
    if not found.uphill and went_down(factors.graph(), start, found):
        return found
    rest = LevenbergMarquardt(watch).solve(factors, found.values, params)
    return replace(rest, before=found.before, iterations=found.iterations + rest.iterations, fallback=True)


def _descend(solver: gtsam.NonlinearOptimizer, factors: Factors, params: Params, watch: Watch) -> Solution:
    """Iterates until the error falls no more, or would not with the next step, or rises."""
    before = error = float(solver.error())
    # GTSAM lends its values only until the next step.
    values, decrease = gtsam.Values(solver.values()), np.inf
    try:
        while solver.iterations() < params.Optimizer.Iterations:
            solver.iterate()
            last, decrease = decrease, error - float(solver.error())
            if not decrease > 0.0:
                break
            error, values = error - decrease, gtsam.Values(solver.values())
            watch(values, 2.0 * error)
            if _is_last(solver, last, decrease, max(params.Optimizer.Epsilon * error, _ROUNDING)):
                break
    except RuntimeError as failure:
        raise unsolvable(factors, failure) from failure
    uphill = decrease < -max(params.Optimizer.Epsilon * error, _ROUNDING)
    return Solution(values, 2.0 * before, 2.0 * error, int(solver.iterations()), uphill=bool(uphill))


def _is_last(solver: gtsam.NonlinearOptimizer, last: float, decrease: float, least: float) -> bool:
    """Whether the next step is not worth taking.

    Undamped steps near the minimum converge at least with order 1.5, and so do their decreases, which tells the next.
    """
    if decrease <= least:
        return True
    if isinstance(solver, gtsam.LevenbergMarquardtOptimizer) and solver.lambda_() > _UNDAMPED:
        return False
    return decrease < _FAST * last < np.inf and decrease * (decrease / last) ** 1.5 <= least


def _truncated(factors: Factors, graph: gtsam.NonlinearFactorGraph, at: gtsam.Values) -> float:
    """Cost with each loop's share cut off at the threshold."""
    shares = [float(np.square(_whitened(factors.factors[row], at)).sum()) for row in factors.loops]
    limits = [OUTLIER_CHI2[factors.factors[row].dim()] for row in factors.loops]
    return cost(graph, at) - sum(max(0.0, share - limit) for share, limit in zip(shares, limits, strict=True))


def _whitened(factor: gtsam.NoiseModelFactor, at: gtsam.Values) -> Array:
    """Residual in sigmas, whatever the kernel."""
    return np.asarray(factor.noiseModel().unweightedWhiten(factor.unwhitenedError(at)))
