"""Pose graph optimisation with GTSAM, the only file that knows of it.

GTSAM orders the tangent of a Pose3 rotation first; links have their information translation first, as everywhere in
slamdeck. The rows and columns are exchanged here and nowhere else.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import gtsam
import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose
from slam.graph.graph import PoseGraph, ascending, name
from slam.params import Params
from slam.types import Link

#: Eigenvalues of information allowed; LM takes no step, without saying so, on graphs with wilder ones.
MIN_INFORMATION = 1e-6
MAX_INFORMATION = 1e9
_ANCHOR_SIGMA = 1e-6
_ROTATION_FIRST = np.array([3, 4, 5, 0, 1, 2])
#: A decrease that LM promises and doesn't deliver is an error from this share of chi2 on.
_STUCK = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Optimized:
    """Outcome of an optimisation.

    Attributes:
        poses: id -> (4, 4) ``T_map_base`` of every node of the graph; those in ``dropped`` are as they were.
        chi2_before: sum of squared, whitened residuals of the links at the start.
        chi2_after: the same at the end.
        iterations: of the solver.
        seconds: time this took.
        root: id held where it was.
        dropped: ids that no links join with the root.
        clamped: number of links whose information had eigenvalues out of bounds.
        fallback: whether LM took no step and only Ceres' parameters for it found the way.
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


def optimize(graph: PoseGraph, params: Params, *, root: int | None = None) -> Optimized:
    """Poses of least chi2, by Levenberg-Marquardt from the graph's poses; the graph itself stays as it is.

    Args:
        graph: poses to start from and links.
        params: ``Optimizer/Iterations``, ``Optimizer/Epsilon``, ``RGBD/OptimizeFromGraphEnd``.
        root: id to hold fixed; by default what ``choose_root`` gives for the newest node.

    Raises:
        OptimizationError: the graph is empty, a link has no finite values, or the solver finds no way down.
    """
    start = time.perf_counter()
    root = choose_root(graph, params, graph.newest) if root is None else root
    ids = sorted(graph.component(root))
    dropped = tuple(sorted(graph.poses.keys() - set(ids)))
    inside = set(ids)
    links = [graph.links[pair] for pair in sorted(graph.links) if pair[0] in inside]
    if not links:
        return Optimized(dict(graph.poses), 0.0, 0.0, 0, time.perf_counter() - start, root, dropped)
    factors, clamped = _factors(links)
    factors.add(_anchor(root, graph.poses[root]))
    run = _solve(factors, _values(ids, graph.poses), params)
    moved = dict(zip(ids, _matrices(run.final), strict=True))
    poses = {i: moved.get(i, T) for i, T in graph.poses.items()}
    poses[root] = graph.poses[root]
    seconds = time.perf_counter() - start
    return Optimized(poses, run.before, run.after, run.iterations, seconds, root, dropped, clamped, run.fallback)


def choose_root(graph: PoseGraph, params: Params, node_id: int) -> int:
    """The node held fixed among those joined with ``node_id``: the oldest, or with OptimizeFromGraphEnd the newest."""
    component = graph.component(node_id)
    return max(component) if params.RGBD.OptimizeFromGraphEnd else min(component)


def chi2(links: Sequence[Link], poses: dict[int, Pose]) -> float:
    """Sum of squared, whitened residuals of these links at these poses."""
    if not links:
        return 0.0
    factors, _ = _factors(links)
    ids = sorted({i for link in links for i in link.pair})
    return float(2.0 * factors.error(_values(ids, poses)))


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """One run of the solver: where it ended, chi2 at both ends, iterations, and whether it was the second try."""

    final: gtsam.Values
    before: float
    after: float
    iterations: int
    fallback: bool


def _solve(factors: gtsam.NonlinearFactorGraph, initial: gtsam.Values, params: Params) -> _Run:
    lm = gtsam.LevenbergMarquardtParams()
    lm.setMaxIterations(params.Optimizer.Iterations)
    lm.setRelativeErrorTol(params.Optimizer.Epsilon)
    run = _run(factors, initial, lm, fallback=False)
    if run.after < run.before or _at_minimum(factors, initial, run.before):
        return run
    run = _run(factors, initial, gtsam.LevenbergMarquardtParams.CeresDefaults(), fallback=True)
    if run.after < run.before:
        return run
    raise OptimizationError(
        f"the optimiser finds no way down from chi2 {run.before:.6g} ({factors.size() - 1} links, "
        f"{run.iterations} iterations end at {run.after:.6g}); look for links with wrong information"
    )


def _run(
    factors: gtsam.NonlinearFactorGraph, initial: gtsam.Values, lm: gtsam.LevenbergMarquardtParams, *, fallback: bool
) -> _Run:
    solver = gtsam.LevenbergMarquardtOptimizer(factors, initial, lm)
    before = 2.0 * solver.error()
    try:
        final = solver.optimize()
    except RuntimeError as error:
        raise OptimizationError(f"GTSAM can't solve {factors.size() - 1} links: {str(error).strip()}") from error
    return _Run(final, before, 2.0 * solver.error(), int(solver.iterations()), fallback)


def _at_minimum(factors: gtsam.NonlinearFactorGraph, values: gtsam.Values, before: float) -> bool:
    """Whether even the linearised problem promises no decrease worth the name."""
    if before < 1e-9:
        return True
    linear = factors.linearize(values)
    try:
        promised = 2.0 * linear.error(linear.optimize())
    except RuntimeError:
        return False
    return before - promised <= _STUCK * before


def _factors(links: Sequence[Link]) -> tuple[gtsam.NonlinearFactorGraph, int]:
    """Factors of these links, and how many of them had to have their information clamped."""
    factors, clamped = gtsam.NonlinearFactorGraph(), 0
    for link in links:
        factor, was_clamped = _factor(link)
        factors.add(factor)
        clamped += was_clamped
    return factors, clamped


@lru_cache(maxsize=1 << 15)
def _factor(link: Link) -> tuple[gtsam.BetweenFactorPose3, bool]:
    """The factor of a link, made once: making it costs as much as a solver iteration."""
    link = ascending(link)
    assert link.T_from_to is not None
    if not (np.isfinite(link.T_from_to).all() and np.isfinite(link.information).all()):
        raise OptimizationError(f"link {name(link)}: transform and information must be finite numbers")
    information = 0.5 * (link.information + link.information.T)[_ROTATION_FIRST[:, None], _ROTATION_FIRST]
    clamped = _out_of_bounds(information)
    if clamped:
        eigenvalues, vectors = np.linalg.eigh(information)
        information = (vectors * eigenvalues.clip(MIN_INFORMATION, MAX_INFORMATION)) @ vectors.T
    model = gtsam.noiseModel.Gaussian.Information(information)
    T_from_to = _orthonormal(link.T_from_to)
    return gtsam.BetweenFactorPose3(link.from_id, link.to_id, gtsam.Pose3(T_from_to), model), clamped


def _out_of_bounds(information: Array) -> bool:
    """Whether an eigenvalue lies outside; Gershgorin's circles spare most links the decomposition."""
    diagonal = information.diagonal()
    radius = np.abs(information).sum(axis=1) - np.abs(diagonal)
    if (diagonal - radius).min() >= MIN_INFORMATION and (diagonal + radius).max() <= MAX_INFORMATION:
        return False
    eigenvalues = np.linalg.eigvalsh(information)
    return bool(eigenvalues[0] < MIN_INFORMATION or eigenvalues[-1] > MAX_INFORMATION)


def _orthonormal(T: Array) -> Array:
    """Poses (..., 4, 4) with rotations orthonormal to double precision (files store single): one Newton step."""
    R = T[..., :3, :3]
    clean = T.copy()
    clean[..., :3, :3] = 1.5 * R - 0.5 * R @ np.swapaxes(R, -1, -2) @ R
    return clean


def _anchor(root: int, T_map_base: Pose) -> gtsam.PriorFactorPose3:
    noise = gtsam.noiseModel.Isotropic.Sigma(6, _ANCHOR_SIGMA)
    return gtsam.PriorFactorPose3(root, gtsam.Pose3(_orthonormal(T_map_base)), noise)


def _values(ids: Sequence[int], poses: dict[int, Pose]) -> gtsam.Values:
    values = gtsam.Values()
    for node_id, T in zip(ids, _orthonormal(np.array([poses[i] for i in ids])), strict=True):
        values.insert(node_id, gtsam.Pose3(T))
    return values


def _matrices(values: gtsam.Values) -> Array:
    """Poses (N, 4, 4) in ascending order of their keys."""
    rows = gtsam.utilities.extractPose3(values)
    T = np.zeros((len(rows), 4, 4))
    T[:, :3, :3] = rows[:, :9].reshape(-1, 3, 3)
    T[:, :3, 3] = rows[:, 9:]
    T[:, 3, 3] = 1.0
    return T
