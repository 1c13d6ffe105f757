"""iSAM2: an optimisation that goes on from the last one (``GTSAM/Incremental``)."""

from __future__ import annotations

from dataclasses import dataclass, field

import gtsam
import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array
from slam.graph.factors import Factors
from slam.graph.graph import PoseGraph
from slam.graph.solvers import Solution, cost, no_way_down, unsolvable, went_down
from slam.graph.spaces import Space
from slam.graph.start import without
from slam.params import Params

_DOGLEG = 2
#: Metres: the root is put back exactly where it was, and rotations are made orthonormal.
_SAME = 1e-6
#: Nodes have smaller keys in GTSAM.
_FIRST_LANDMARK = 1 << 56


@dataclass(slots=True, eq=False)
class State:
    """What is kept from one call to the next.

    Attributes:
        solver: GTSAM's.
        settings: parameters it was made with.
        indices: of the factors in it, by what they were made of.
        values: at the end of the last call.
    """

    solver: gtsam.ISAM2
    settings: tuple[object, ...]
    indices: dict[object, int] = field(default_factory=dict)
    values: gtsam.Values = field(default_factory=gtsam.Values)


class Incremental:
    """Takes in what is new in a graph and takes out what is gone, as long as its poses are those of the last call.

    After a refused loop, a decision or a new root it starts from the whole problem.
    """

    def __init__(self, graph: PoseGraph, space: Space) -> None:
        self._graph, self._space = graph, space

    def solve(self, factors: Factors, start: gtsam.Values, params: Params) -> Solution:
        """By the parameters of the group ``GTSAM``, ``Optimizer/Iterations`` and ``Optimizer/Epsilon``."""
        whole = factors.graph()
        before = cost(whole, start)
        state = self._state(start, params)
        try:
            self._take_in(state, factors, start)
            values, iterations = _settle(state.solver, whole, params)
        except RuntimeError as error:
            self._graph.solver_state = None
            raise unsolvable(factors, error) from error
        found = Solution(values, before, cost(whole, values), iterations)
        if not went_down(whole, start, found):
            self._graph.solver_state = None
            raise no_way_down(factors, found, "GTSAM/Incremental=false solves the whole graph anew")
        state.values = values
        return found

    def _state(self, start: gtsam.Values, params: Params) -> State:
        settings = (
            params.GTSAM.IncRelinearizeThreshold,
            params.GTSAM.IncRelinearizeSkip,
            params.GTSAM.Optimizer == _DOGLEG,
            self._space,
        )
        kept = self._graph.solver_state
        if isinstance(kept, State) and kept.settings == settings and _continues(kept.values, start, self._space):
            return kept
        state = State(gtsam.ISAM2(_options(*settings[:3])), settings)
        self._graph.solver_state = state
        return state

    def _take_in(self, state: State, factors: Factors, start: gtsam.Values) -> None:
        wanted = dict(zip(factors.keys, factors.factors, strict=True))
        gone = [key for key in state.indices if key not in wanted]
        new = [key for key in wanted if key not in state.indices]
        added, theta = gtsam.NonlinearFactorGraph(), gtsam.Values(start)
        for key in new:
            added.add(wanted[key])
        for variable in state.values.keys():  # noqa: SIM118 - GTSAM's Values can't be iterated
            theta.erase(variable)
        result = state.solver.update(added, theta, [state.indices.pop(key) for key in gone])
        state.indices.update(zip(new, result.getNewFactorsIndices(), strict=True))


def _options(threshold: float, skip: int, dogleg: bool) -> gtsam.ISAM2Params:
    options = gtsam.ISAM2Params()
    options.setRelinearizeThreshold(threshold)
    options.relinearizeSkip = skip
    options.setOptimizationParams(gtsam.ISAM2DoglegParams() if dogleg else gtsam.ISAM2GaussNewtonParams())
    return options


def _continues(kept: gtsam.Values, start: gtsam.Values, space: Space) -> bool:
    """Whether the nodes of the last call are all there, where it left them."""
    (kept_ids, kept_rows), (ids, rows) = _nodes(kept, space), _nodes(start, space)
    there = np.isin(ids, kept_ids)
    return int(there.sum()) == len(kept_ids) and np.allclose(rows[there], kept_rows, rtol=0.0, atol=_SAME)


def _nodes(values: gtsam.Values, space: Space) -> tuple[NDArray[np.int64], Array]:
    """Ids (N,) of nodes, and their poses (N, 4, 4)."""
    ids = np.array([key for key in values.keys() if key < _FIRST_LANDMARK], np.int64)  # noqa: SIM118
    landmarks = [key for key in values.keys() if key >= _FIRST_LANDMARK]  # noqa: SIM118
    return ids, space.poses(without(values, landmarks))


def _settle(solver: gtsam.ISAM2, whole: gtsam.NonlinearFactorGraph, params: Params) -> tuple[gtsam.Values, int]:
    """Steps until the error falls no more; the best values on the way and the number of steps."""
    values = solver.calculateEstimate()
    error = cost(whole, values)
    for step in range(1, params.Optimizer.Iterations):
        solver.update()
        next_values = solver.calculateEstimate()
        next_error = cost(whole, next_values)
        if not next_error < error * (1.0 - params.Optimizer.Epsilon):
            return (next_values if next_error < error else values), step
        values, error = next_values, next_error
    return values, params.Optimizer.Iterations
