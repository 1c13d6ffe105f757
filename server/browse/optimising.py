"""Optimising a map's graph otherwise than it is: looked at step by step, never stored."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from server.browse.snapshot import Snapshot
from server.errors import NotFoundError
from server.schemas import GraphState, KeepPoses, OptimiseAsk, Optimised, TurnMap
from slam.edit.wishes import Optimisation, Turn
from slam.evaluate import align
from slam.geometry import Array, Pose
from slam.graph.course import Course as Solution
from slam.graph.course import course
from slam.graph.optimizer import optimize
from slam.graph.problem import Problem
from slam.graph.shift import Shift
from slam.types import LinkType, Manner

#: Results that a slider may come back to.
_KEPT = 4


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
            NotFoundError: the map has no such root, or there is no such kind of link.
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


def wanted_manner(ask: OptimiseAsk) -> Manner:
    """What the engine is asked for; raises NotFoundError where there is no such kind of link."""
    kinds = {kind.label: kind for kind in LinkType}
    for name in ask.without:
        if name not in kinds:
            raise NotFoundError(f"{name!r} is no kind of link: {', '.join(kinds)} are")
    without = tuple(sorted({kinds[name] for name in ask.without}))
    return Manner(root=ask.root, without=without, solver=ask.solver, kernel=ask.kernel, start=ask.start)


def wanted_optimisation(body: KeepPoses, author: str) -> Optimisation:
    """What the engine is asked for; raises NotFoundError where there is no such kind of link."""
    return Optimisation(manner=wanted_manner(body.ask), step=body.step, author=author)


def wanted_turn(body: TurnMap, author: str) -> Turn:
    """What the engine is asked for."""
    return Turn(yaw_rad=float(np.radians(body.yaw_deg)), to=body.to, author=author)


def _course(snapshot: Snapshot, ask: OptimiseAsk) -> Course:
    if ask.root is not None and ask.root not in snapshot.graph:
        raise NotFoundError(f"the map has no node {ask.root} to hold fixed")
    now = snapshot.graph.poses
    done = course(snapshot.graph, snapshot.params, wanted_manner(ask))
    solved, problem = done.solved, Problem.of(done.graph, done.root, done.params)
    ids = list(problem.ids)
    paths = [_path(snapshot, poses, ids, aligned=ask.align) for poses, _ in done.steps]
    told = Optimised(
        root=done.root,
        nodes=len(ids),
        links=len(problem.measurements),
        dropped=len(solved.dropped),
        now=_state(snapshot, done, now, _cost(done, now), ids),
        steps=[_state(snapshot, done, poses, cost, ids) for poses, cost in done.steps],
        seconds=round(solved.seconds, 4),
        max_shift_m=Shift.between({i: now[i] for i in ids}, {i: solved.poses[i] for i in ids}).max_m,
        outliers=[[b, a] for a, b in solved.outliers],
        fallback=solved.fallback,
    )
    return Course(told, ids, paths)


def _cost(done: Solution, poses: Mapping[int, Pose]) -> float:
    """What the same links cost at other poses: a solver that may not take a step tells that."""
    other = done.graph.copy()
    other.poses = dict(poses)
    params = done.params.changed({"Optimizer/Iterations": 1, "GTSAM/Optimizer": 0})
    return optimize(other, params, root=done.root).chi2_before


def _state(snapshot: Snapshot, done: Solution, poses: Mapping[int, Pose], cost: float, ids: list[int]) -> GraphState:
    positions = np.array([poses[i][:3, 3] for i in ids]).reshape(-1, 3)
    taking_part = {**snapshot.poses, **poses}
    return GraphState(
        chi2=cost,
        ate_m=snapshot.truth.ate_at(taking_part, done.graph.links),
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
