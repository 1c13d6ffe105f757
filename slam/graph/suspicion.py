"""Which loop links are likely to be false, judged by what was measured and not by where the optimiser put things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.errors import OptimizationError
from slam.geometry import Array, Pose, adjoint, inverse
from slam.graph.graph import Pair, PoseGraph
from slam.graph.odometry_chain import OdometryChain, informations, sound, transforms
from slam.graph.optimizer import optimize
from slam.graph.shift import angles
from slam.graph.verify import residual_sigmas
from slam.params import Params
from slam.types import Link

#: Loops that a loop is compared with, the nearest ones along the paths.
_NEIGHBORS = 10
#: A disagreement of more than this, times what is usual in the map, is held against a loop.
_LIMIT = 3.0
#: What is usual: this quantile of all loops in the graph, joined by so many that are off by their sigma. Of few loops
#: the false ones would say what is usual.
_USUAL, _HONEST = 0.75, 4
#: How often the map is straightened without the worst loops, by how many steps of the solver: that ranks the loops.
_ROUNDS, _STEPS = 2, 2
#: Loops that have this share of the worst one's blame are taken out with it.
_SHARE = 1.0 / 3.0
#: Loops whose distances to all others are worked out at once.
_PART = 256


@dataclass(frozen=True, slots=True)
class Suspicion:
    """What speaks against a loop.

    Attributes:
        residual: how far the poses are from it that the links have without the worst loops, in its sigmas; NaN while
            it is not in the graph.
        odometry: how far odometry alone is from it, in sigmas of both (root mean square over the six axes); NaN where
            odometry does not join its ends.
        neighbors: the same for the loops near by, each with the odometry between (median); NaN without such loops.
        compared: loops near by that it was compared with.
        agreeing: those of them that it agrees with.
        score: the largest of the three over what is allowed: above 1 it is suspect.
    """

    residual: float
    odometry: float
    neighbors: float
    compared: int
    agreeing: int
    score: float


def suspicions(graph: PoseGraph, loops: Sequence[Link], params: Params | None = None) -> dict[Pair, Suspicion]:
    """What speaks against each of these links, by its pair; unsound ones are left out.

    Odometry and the loops' covariances are rarely right to a factor of ten; what most loops of a map show is usual
    there, and each disagreement is measured against it. Loops are compared in pairs as in PCM (Mangelson 2018,
    equation 1), each with the nearest ones only. A false loop bends the map, and the true ones near it with it: so
    the map is straightened without those that strain it and that the other two tests speak against, and all are held
    against what is left.

    Args:
        graph: with poses; its loop links are what the others are compared with.
        loops: links between nodes of the graph, of the graph or not, with a transform.
        params: how the graph is optimised, and the sigmas that its poses may be off (``RGBD/OptimizeMaxError``;
            0 counts as 3).
    """
    params = params or Params()
    trusted = sound(link for _, link in sorted(graph.links.items()) if link.type.is_loop)
    judged = sound(loops)
    if not judged:
        return {}
    chain, row = OdometryChain(graph), {link.pair: k for k, link in enumerate(trusted)}
    others = [link for link in judged if link.pair not in row]
    every = [*trusted, *others]
    row |= {link.pair: k for k, link in enumerate(others, start=len(trusted))}
    odometry = _against_odometry(chain, every)
    compared = _against_each_other(chain, every, trusted)
    neighbors, counts = _medians(compared)
    known = len(trusted)
    allowed = _LIMIT * np.array([_usual(odometry[:known]), _usual(neighbors[:known])])
    measured = np.fmax(odometry / allowed[0], neighbors / allowed[1])
    strain = _Strain(graph, trusted, np.nan_to_num(measured[:known]), params)
    residual = np.append(strain.residual, np.full(len(others), np.nan))
    score = np.nan_to_num(np.fmax(measured, np.append(strain.ratio, np.full(len(others), np.nan))))
    agreeing = (compared <= allowed[1]).sum(axis=1)
    columns = np.column_stack([residual, odometry, neighbors, counts, agreeing, score])
    return {link.pair: _suspicion(columns[row[link.pair]]) for link in judged}


def _suspicion(values: Array) -> Suspicion:
    residual, odometry, neighbors, compared, agreeing, score = values.tolist()
    return Suspicion(residual, odometry, neighbors, int(compared), int(agreeing), score)


def _usual(disagreement: Array) -> float:
    known = disagreement[np.isfinite(disagreement)]
    return float(np.quantile(np.append(known, np.ones(_HONEST)), _USUAL))


class _Strain:
    """How far the loops of a graph are from its poses once those that strain it most are left out.

    Attributes:
        residual: (N,) in sigmas of each loop.
        ratio: (N,) the same over what is allowed.
    """

    def __init__(self, graph: PoseGraph, loops: Sequence[Link], measured: Array, params: Params) -> None:
        self._loops, self._limit = loops, params.RGBD.OptimizeMaxError or _LIMIT
        self._look(graph.poses)
        few, poses = params.changed({"Optimizer/Iterations": _STEPS}), graph.poses
        out = np.zeros(len(loops), np.bool_)
        for _ in range(_ROUNDS):
            blame = np.where((self.ratio > 1.0) & ~out, self.ratio * measured, 0.0)
            worst = (blame > 0.0) & (blame >= _SHARE * blame.max(initial=0.0))
            if not worst.any():
                return
            out = worst | (out & (self.ratio > 1.0))
            try:
                poses = _without(graph, poses, [link for link, gone in zip(loops, out, strict=True) if gone], few)
            except OptimizationError:
                # What the solver can't straighten is judged as it is.
                return
            self._look(poses)

    def _look(self, poses: Mapping[int, Pose]) -> None:
        self.residual = residual_sigmas(self._loops, poses)
        self.ratio = self.residual / (self._limit * _usual(self.residual))


def _without(graph: PoseGraph, poses: dict[int, Pose], loops: Sequence[Link], params: Params) -> dict[int, Pose]:
    rest = graph.copy()
    rest.poses = poses
    for link in loops:
        rest.remove_link(link.pair)
    return optimize(rest, params).poses


def _against_odometry(chain: OdometryChain, loops: Sequence[Link]) -> Array:
    """(N,) sigmas between each loop and the path between its ends."""
    if not loops:
        return np.zeros(0)
    path = chain.relative(*_pairs(loops).T)
    sigmas = _sigmas(transforms(loops), path.T_a_b, _covariances(loops) + path.covariance)
    return np.where(path.known, sigmas, np.nan)


def _against_each_other(chain: OdometryChain, judged: Sequence[Link], trusted: Sequence[Link]) -> Array:
    """(N, M) sigmas between each judged loop and M loops near by, NaN where there are less.

    The one way is along the loop, the other along the path to the other, along it and back.
    """
    near = _near(judged, trusted)
    rows, columns = np.nonzero(near >= 0)
    found = np.full(near.shape, np.nan)
    if not len(rows):
        return found
    others = near[rows, columns]
    a, b = _pairs(judged)[rows], _pairs(trusted)[others]
    out = chain.relative(a[:, 0], b[:, 0])
    back = chain.relative(b[:, 1], a[:, 1])
    T_b, known = transforms(trusted)[others], out.known & back.known
    # Errors on the way, carried to the end of the way.
    covariance = _covariances(judged)[rows] + back.covariance
    covariance += _carried(_covariances(trusted)[others], back.T_a_b) + _carried(out.covariance, T_b @ back.T_a_b)
    sigmas = _sigmas(transforms(judged)[rows], out.T_a_b @ T_b @ back.T_a_b, covariance)
    found[rows, columns] = np.where(known, sigmas, np.nan)
    return found


def _medians(compared: Array) -> tuple[Array, NDArray[np.int64]]:
    """Median (N,) of what is known in each row, NaN without anything, and how many that are."""
    counts = np.isfinite(compared).sum(axis=1)
    ordered = np.column_stack([np.sort(compared, axis=1), np.full(len(compared), np.nan)])
    row = np.arange(len(compared))
    return 0.5 * (ordered[row, (counts - 1) // 2] + ordered[row, counts // 2]), counts


def _near(judged: Sequence[Link], trusted: Sequence[Link]) -> NDArray[np.int64]:
    """Rows (N, M) of the trusted loops whose ends are nearest to those of a judged one by ids; -1 where there are less.

    A loop is none of those near it.
    """
    pairs, ends = _pairs(judged), _pairs(trusted)
    most = min(_NEIGHBORS + 1, len(ends))
    found = np.full((len(pairs), _NEIGHBORS), -1, np.int64)
    for first in range(0, len(pairs) if most else 0, _PART):
        part = pairs[first : first + _PART]
        far = np.abs(part[:, None, 0] - ends[:, 0]) + np.abs(part[:, None, 1] - ends[:, 1])
        nearest = np.argpartition(far, most - 1, axis=1)[:, :most]
        distance = np.take_along_axis(far, nearest, axis=1)
        order = np.lexsort((nearest, distance))
        nearest, distance = (np.take_along_axis(values, order, axis=1) for values in (nearest, distance))
        own = distance[:, :1] == 0
        kept = np.where(own, nearest[:, 1:], nearest[:, :-1])[:, :_NEIGHBORS]
        if most <= _NEIGHBORS:
            # All of them are near: without itself one is missing.
            kept = np.column_stack([kept, np.where(own[:, 0], -1, nearest[:, -1])])
        found[first : first + len(part), : kept.shape[1]] = kept
    return found


def _sigmas(measured: Array, expected: Array, covariance: Array) -> Array:
    """(N,) root mean square over the axes of whitened differences of transforms (N, 4, 4)."""
    difference = inverse(measured) @ expected
    error = np.concatenate([difference[:, :3, 3], _rotation_vectors(difference)], axis=1)
    whitened = np.linalg.solve(covariance, error[:, :, None])[:, :, 0]
    return np.asarray(np.sqrt(np.maximum((error * whitened).sum(axis=1), 0.0) / 6.0))


def _rotation_vectors(T: Array) -> Array:
    """(N, 3) axis times angle; half a turn about any axis is as wrong as about another."""
    R, angle = T[:, :3, :3], angles(T)
    axis = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    length = np.linalg.norm(axis, axis=1)
    axis[length < 1e-9] = (1.0, 0.0, 0.0)
    return np.asarray(axis * (angle / np.maximum(length, 1e-9))[:, None])


def _carried(covariance: Array, T_end: Array) -> Array:
    """Covariances (N, 6, 6) of a frame in axes of one that lies at ``T_end`` (N, 4, 4) from it."""
    Ad = adjoint(inverse(T_end))
    return np.asarray(Ad @ covariance @ np.swapaxes(Ad, 1, 2))


def _pairs(loops: Sequence[Link]) -> NDArray[np.int64]:
    """(N, 2) both ids of each, smaller first."""
    return np.array([link.pair for link in loops], np.int64).reshape(-1, 2)


def _covariances(loops: Sequence[Link]) -> Array:
    return np.asarray(np.linalg.inv(informations(loops)))
