"""Optimising a map's graph otherwise than it is: looked at step by step, never stored."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from server.browse.snapshot import Snapshot
from server.errors import NotFoundError
from server.schemas import GraphState, OptimiseAsk, Optimised
from slam.evaluate import align
from slam.geometry import Array, Pose
from slam.graph.completion import chained
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import choose_root, optimize
from slam.graph.problem import Problem
from slam.graph.shift import Shift
from slam.params import Params
from slam.types import LinkType

#: Results that a slider may come back to.
_KEPT = 4
#: Steps that are kept of an optimisation, the last of them.
_MOST_STEPS = 200


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """An optimisation with all its steps.

    Attributes:
        told: its numbers.
        ids: (N,) nodes that took part, ascending.
        paths: of each step, (N, 4, 4) ``T_map_base``.
    """

    told: Optimised
    ids: list[int]
    paths: list[Array]


class Optimisations:
    """The last few optimisations that somebody asked for of one map."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._known: OrderedDict[tuple[int, str], Course] = OrderedDict()

    def course(self, snapshot: Snapshot, ask: OptimiseAsk) -> Course:
        """What comes of it; the same question is answered once.

        Raises:
            NotFoundError: the map has no such root.
            OptimizationError: there is nothing to optimise, or no way down.
        """
        key = (snapshot.revision, ask.model_dump_json())
        with self._lock:
            found = self._known.get(key)
            if found is None:
                found = self._known[key] = _course(snapshot, ask)
            self._known.move_to_end(key)
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
            return found


def _course(snapshot: Snapshot, ask: OptimiseAsk) -> Course:
    graph, params = _graph(snapshot, ask), _params(snapshot.params, ask)
    if ask.root is not None and ask.root not in graph:
        raise NotFoundError(f"the map has no node {ask.root} to hold fixed")
    root = choose_root(graph, params, graph.newest) if ask.root is None else ask.root
    now = dict(graph.poses)
    if ask.start == "odometry":
        # From where the root is in the map, so that both graphs lie over each other.
        start = chained(graph, root)
        T = now[root] @ np.linalg.inv(start[root])
        graph.poses |= {i: T @ pose for i, pose in start.items()}
    seen: list[tuple[dict[int, Pose], float]] = []
    solved = optimize(graph, params, root=root, watch=lambda poses, cost: seen.append((poses, cost)))
    problem = Problem.of(graph, root, params)
    ids = list(problem.ids)
    steps = [(dict(graph.poses), solved.chi2_before), *seen[-_MOST_STEPS:]]
    # Solvers that nobody can watch, and what a second one found.
    if len(steps) == 1 or steps[-1][1] != solved.chi2_after:
        steps.append((solved.poses, solved.chi2_after))
    paths = [_path(snapshot, poses, ids, aligned=ask.align) for poses, _ in steps]
    told = Optimised(
        root=root,
        nodes=len(ids),
        links=len(problem.measurements),
        dropped=len(solved.dropped),
        now=_state(snapshot, graph, now, _cost(graph, params, root, now), ids),
        steps=[_state(snapshot, graph, poses, cost, ids) for poses, cost in steps],
        seconds=round(solved.seconds, 4),
        max_shift_m=Shift.between({i: now[i] for i in ids}, {i: solved.poses[i] for i in ids}).max_m,
        outliers=[[b, a] for a, b in solved.outliers],
        fallback=solved.fallback,
    )
    return Course(told, ids, paths)


def _graph(snapshot: Snapshot, ask: OptimiseAsk) -> PoseGraph:
    graph, left_out = snapshot.graph.copy(), set(ask.without)
    for pair in [pair for pair, link in graph.links.items() if link.type.label in left_out]:
        graph.remove_link(pair)
    for key in [key for key in graph.constraints if key[2].label in left_out]:
        del graph.constraints[key]
    return graph


def _params(params: Params, ask: OptimiseAsk) -> Params:
    changes: dict[str, bool | int | str] = {"GTSAM/Incremental": False}
    if ask.solver is not None:
        changes["GTSAM/Optimizer"] = ask.solver
    if ask.kernel is not None:
        changes["Optimizer/Robust"] = ask.kernel != "none"
    if ask.kernel not in (None, "none"):
        changes["Optimizer/RobustKernel"] = str(ask.kernel)
    if LinkType.LANDMARK.label in ask.without:
        changes["Optimizer/LandmarksIgnored"] = True
    return params.changed(changes)


def _cost(graph: PoseGraph, params: Params, root: int, poses: dict[int, Pose]) -> float:
    """What the same links cost at other poses: a solver that may not take a step tells that."""
    other = graph.copy()
    other.poses = dict(poses)
    first = optimize(other, params.changed({"Optimizer/Iterations": 1, "GTSAM/Optimizer": 0}), root=root)
    return first.chi2_before


def _state(snapshot: Snapshot, graph: PoseGraph, poses: Mapping[int, Pose], cost: float, ids: list[int]) -> GraphState:
    positions = np.array([poses[i][:3, 3] for i in ids]).reshape(-1, 3)
    taking_part = {**snapshot.poses, **poses}
    return GraphState(
        chi2=cost,
        ate_m=snapshot.truth.ate_at(taking_part, graph.links),
        path_m=float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum()),
    )


def _path(snapshot: Snapshot, poses: Mapping[int, Pose], ids: list[int], *, aligned: bool) -> Array:
    """The poses (N, 4, 4) of a step, laid over the true path as the 3D view has it where that is asked for."""
    T = np.array([poses[i] for i in ids]).reshape(-1, 4, 4)
    if not aligned or not snapshot.truth.is_known:
        return T
    true = snapshot.truth.T_map_world @ snapshot.nodes.T_world[[snapshot.rows[i] for i in ids]]
    known = np.isfinite(true[:, 0, 3])
    return np.asarray(align(true[known, :3, 3], T[known, :3, 3]) @ T) if known.sum() > 1 else T
