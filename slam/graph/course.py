"""A graph optimised otherwise than its parameters say, with every iteration; the graph itself stays as it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Pose
from slam.graph.completion import chained
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import Optimized, choose_root, optimize
from slam.params import Params
from slam.types import LinkType, Manner, Placement

#: Iterations that are kept of an optimisation, the last of them.
_MOST_STEPS = 200


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """An optimisation with all its steps.

    Attributes:
        graph: what was optimised: the links that count, at the poses where it began.
        params: with which.
        root: the node held fixed.
        solved: what came of it.
        steps: id -> (4, 4) ``T_map_base`` and chi2 of the start and of each iteration; of solvers that nobody can watch
            start and end. Iterations have the nodes that took part alone, and landmarks.
    """

    graph: PoseGraph
    params: Params
    root: int
    solved: Optimized
    steps: list[tuple[Mapping[int, Pose], float]]


def course(graph: PoseGraph, params: Params, manner: Manner) -> Course:
    """Optimise a graph in another manner.

    Raises:
        OptimizationError: the graph has no such root, there is nothing to optimise, or no way down.
    """
    if manner.root is not None and manner.root not in graph:
        raise OptimizationError(f"the map has no node {manner.root} to hold fixed")
    part, chosen = _part(graph, manner), _params(params, manner)
    root = choose_root(part, chosen, part.newest) if manner.root is None else manner.root
    if manner.start == "odometry":
        # From where the root is in the map, so that both graphs lie over each other.
        start = chained(part, root)
        T = part.poses[root] @ np.linalg.inv(start[root])
        part.poses |= {i: T @ pose for i, pose in start.items()}
    seen: list[tuple[Mapping[int, Pose], float]] = []
    solved = optimize(part, chosen, root=root, watch=lambda poses, cost: seen.append((poses, cost)))
    steps = [(dict(part.poses), solved.chi2_before), *seen[-_MOST_STEPS:]]
    # Solvers that nobody can watch, and what a second one found.
    if len(steps) == 1 or steps[-1][1] != solved.chi2_after:
        steps.append((solved.poses, solved.chi2_after))
    return Course(part, chosen, root, solved, steps)


def placed(graph: PoseGraph, params: Params, placement: Placement) -> dict[int, Pose]:
    """Id -> ``T_map_base`` of every node of the graph where a placement has it; what it says nothing of stays.

    Raises:
        OptimizationError: as ``course``, or it has no such iteration.
    """
    T = placement.T_new_old
    if T is not None or placement.manner is None:
        return {i: pose if T is None else T @ pose for i, pose in graph.poses.items()}
    steps = course(graph, params, placement.manner).steps
    step = len(steps) - 1 if placement.step is None else placement.step
    if not 0 <= step < len(steps):
        raise OptimizationError(f"there is no iteration {step}: the optimisation ends with iteration {len(steps) - 1}")
    return {i: steps[step][0].get(i, pose) for i, pose in graph.poses.items()}


def _part(graph: PoseGraph, manner: Manner) -> PoseGraph:
    part = graph.copy()
    for pair in [pair for pair, link in part.links.items() if link.type in manner.without]:
        part.remove_link(pair)
    for key in [key for key in part.constraints if key[2] in manner.without]:
        del part.constraints[key]
    return part


def _params(params: Params, manner: Manner) -> Params:
    changes: dict[str, bool | int | str] = {"GTSAM/Incremental": False}
    if manner.solver is not None:
        changes["GTSAM/Optimizer"] = manner.solver
    if manner.kernel is not None:
        changes["Optimizer/Robust"] = manner.kernel != "none"
    if manner.kernel not in (None, "none"):
        changes["Optimizer/RobustKernel"] = str(manner.kernel)
    if LinkType.LANDMARK in manner.without:
        changes["Optimizer/LandmarksIgnored"] = True
    return params.changed(changes)
