"""Pose graph optimisation with GTSAM, the only file that knows of it.

GTSAM orders the tangent of a Pose3 rotation first; links have their information translation first, as everywhere in
slamdeck. The rows and columns are exchanged here and nowhere else.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import gtsam
import numpy as np

from slam.errors import OptimizationError
from slam.geometry import Array, Pose
from slam.graph.graph import PoseGraph, name
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
    """

    poses: dict[int, Pose]
    chi2_before: float
    chi2_after: float
    iterations: int
    seconds: float
    root: int
    dropped: tuple[int, ...] = ()
    clamped: int = 0


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
    initial = _values(ids, graph.poses)
    before = 2.0 * factors.error(initial)
    final, iterations = _solve(factors, initial, before, params)
    moved = dict(zip(ids, _matrices(final), strict=True))
    poses = {i: moved.get(i, T) for i, T in graph.poses.items()}
    poses[root] = graph.poses[root]
    after = 2.0 * factors.error(final)
    return Optimized(poses, before, after, iterations, time.perf_counter() - start, root, dropped, clamped)


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


def _solve(
    factors: gtsam.NonlinearFactorGraph, initial: gtsam.Values, before: float, params: Params
) -> tuple[gtsam.Values, int]:
    lm = gtsam.LevenbergMarquardtParams()
    lm.setMaxIterations(params.Optimizer.Iterations)
    lm.setRelativeErrorTol(params.Optimizer.Epsilon)
    final, iterations = _run(factors, initial, lm)
    if 2.0 * factors.error(final) < before or _at_minimum(factors, initial, before):
        return final, iterations
    final, iterations = _run(factors, initial, gtsam.LevenbergMarquardtParams.CeresDefaults())
    after = 2.0 * factors.error(final)
    if after < before:
        return final, iterations
    raise OptimizationError(
        f"the optimiser finds no way down from chi2 {before:.6g} (now {after:.6g} after {iterations} iterations, "
        f"{factors.size() - 1} links); look for links with wrong information"
    )


def _run(
    factors: gtsam.NonlinearFactorGraph, initial: gtsam.Values, lm: gtsam.LevenbergMarquardtParams
) -> tuple[gtsam.Values, int]:
    solver = gtsam.LevenbergMarquardtOptimizer(factors, initial, lm)
    try:
        final = solver.optimize()
    except RuntimeError as error:
        raise OptimizationError(f"GTSAM can't solve {factors.size() - 1} links: {str(error).strip()}") from error
    return final, int(solver.iterations())


def _at_minimum(factors: gtsam.NonlinearFactorGraph, values: gtsam.Values, before: float) -> bool:
    """Whether even the linearised problem promises no decrease worth the name."""
    linear = factors.linearize(values)
    try:
        promised = 2.0 * linear.error(linear.optimize())
    except RuntimeError:
        return False
    return before - promised <= _STUCK * before or before < 1e-9


def _factors(links: Sequence[Link]) -> tuple[gtsam.NonlinearFactorGraph, int]:
    transforms = np.array([link.T_from_to for link in links], dtype=np.float64)
    information, clamped = _checked_information(links, transforms)
    transforms = _orthonormal(transforms)
    factors = gtsam.NonlinearFactorGraph()
    models: dict[bytes, gtsam.noiseModel.Base] = {}
    for link, T, matrix in zip(links, transforms, information, strict=True):
        key = matrix.tobytes()
        model = models.get(key)
        if model is None:
            model = models[key] = gtsam.noiseModel.Gaussian.Information(matrix)
        factors.add(gtsam.BetweenFactorPose3(link.from_id, link.to_id, gtsam.Pose3(T), model))
    return factors, clamped


def _checked_information(links: Sequence[Link], transforms: Array) -> tuple[Array, int]:
    """Information (N, 6, 6), rotation first, with eigenvalues within bounds, and how many had to be clamped."""
    stack = np.array([link.information for link in links], dtype=np.float64)
    finite = np.isfinite(stack).all(axis=(1, 2)) & np.isfinite(transforms).all(axis=(1, 2))
    if not finite.all():
        bad = links[int(np.argmin(finite))]
        raise OptimizationError(f"link {name(bad)}: transform and information must be finite numbers")
    stack = 0.5 * (stack + stack.transpose(0, 2, 1))[:, _ROTATION_FIRST[:, None], _ROTATION_FIRST]
    # Gershgorin's circles bound the eigenvalues and spare most links the decomposition.
    diagonal = np.diagonal(stack, axis1=1, axis2=2)
    radius = np.abs(stack).sum(axis=2) - np.abs(diagonal)
    doubtful = np.flatnonzero(
        ((diagonal - radius) < MIN_INFORMATION).any(axis=1) | ((diagonal + radius) > MAX_INFORMATION).any(axis=1)
    )
    clamped = 0
    for row in doubtful:
        eigenvalues, vectors = np.linalg.eigh(stack[row])
        if eigenvalues[0] < MIN_INFORMATION or eigenvalues[-1] > MAX_INFORMATION:
            stack[row] = (vectors * eigenvalues.clip(MIN_INFORMATION, MAX_INFORMATION)) @ vectors.T
            clamped += 1
    return stack, clamped


def _orthonormal(T: Array) -> Array:
    """Rotations of poses (N, 4, 4) made orthonormal to double precision (files store single): one Newton step."""
    R = T[:, :3, :3]
    clean = T.copy()
    clean[:, :3, :3] = 1.5 * R - 0.5 * R @ R.transpose(0, 2, 1) @ R
    return clean


def _anchor(root: int, T_map_base: Pose) -> gtsam.PriorFactorPose3:
    noise = gtsam.noiseModel.Isotropic.Sigma(6, _ANCHOR_SIGMA)
    return gtsam.PriorFactorPose3(root, gtsam.Pose3(_orthonormal(T_map_base[None])[0]), noise)


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
