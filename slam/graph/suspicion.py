"""Which loop links are likely to be false, judged by what was measured and not by where the optimiser put things."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, adjoint, inverse
from slam.graph.graph import Pair, PoseGraph, ascending
from slam.graph.odometry_chain import OdometryChain, is_sound
from slam.graph.shift import angles
from slam.graph.verify import residual_sigmas
from slam.types import Link

#: Loops that a loop is compared with, the nearest ones along the paths.
_NEIGHBORS = 10
#: A disagreement of more than this, in sigmas per axis, is held against a loop.
_LIMIT = 3.0


@dataclass(frozen=True, slots=True)
class Suspicion:
    """What speaks against a loop.

    Attributes:
        residual: how far the optimised poses are from it, in its sigmas; NaN while it is not in the graph.
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


def suspicions(graph: PoseGraph, loops: Sequence[Link], limit: float = _LIMIT) -> dict[Pair, Suspicion]:
    """What speaks against each of these links, by its pair; unsound ones are left out.

    Odometry and the loops' covariances are rarely right to a factor of two; what most loops of a map show is normal
    there, so that each disagreement is measured against the median of all loops in the graph. Loops are compared in
    pairs as in PCM (Mangelson 2018, equation 1), each with the nearest ones only.

    Args:
        graph: with poses; its loop links are what the others are compared with.
        loops: links between nodes of the graph, of the graph or not, with a transform.
        limit: sigmas that the optimised poses may be off (``RGBD/OptimizeMaxError``); 0 counts as 3.
    """
    trusted = [ascending(link) for _, link in sorted(graph.links.items()) if link.type.is_loop and is_sound(link)]
    judged = [ascending(link) for link in loops if is_sound(link)]
    if not judged:
        return {}
    chain = OdometryChain(graph)
    odometry, usual = _against_odometry(chain, judged), _against_odometry(chain, trusted)
    compared = _against_each_other(chain, judged, trusted)
    normal = [d for d in _against_each_other(chain, trusted, trusted) if len(d)]
    scale = _scale(np.array([np.median(d) for d in normal]))
    in_graph = {link.pair for link in trusted}
    residual = _residuals(graph, judged, in_graph)
    allowed = (limit or _LIMIT, _LIMIT * _scale(usual), _LIMIT * scale)
    return {
        link.pair: _suspicion(float(residual[k]), float(odometry[k]), compared[k], allowed)
        for k, link in enumerate(judged)
    }


def _suspicion(residual: float, odometry: float, compared: Array, allowed: tuple[float, float, float]) -> Suspicion:
    neighbors = float(np.median(compared)) if len(compared) else float("nan")
    ratios = np.array([residual, odometry, neighbors]) / allowed
    score = float(np.nanmax(ratios)) if np.isfinite(ratios).any() else 0.0
    agreeing = int((compared <= allowed[2]).sum())
    return Suspicion(residual, odometry, neighbors, len(compared), agreeing, score)


def _scale(usual: Array) -> float:
    """How much larger than its sigmas a disagreement is in this map; 1 where it is smaller, or not known."""
    known = usual[np.isfinite(usual)]
    return max(1.0, float(np.median(known))) if len(known) else 1.0


def _residuals(graph: PoseGraph, loops: Sequence[Link], in_graph: set[Pair]) -> Array:
    residual = np.full(len(loops), np.nan)
    rows = [k for k, link in enumerate(loops) if link.pair in in_graph]
    residual[rows] = residual_sigmas([loops[k] for k in rows], graph.poses)
    return residual


def _against_odometry(chain: OdometryChain, loops: Sequence[Link]) -> Array:
    """(N,) sigmas between each loop and the path between its ends."""
    if not loops:
        return np.zeros(0)
    path = chain.relative((link.from_id for link in loops), (link.to_id for link in loops))
    sigmas = _sigmas(_transforms(loops), path.T_a_b, _covariances(loops) + path.covariance)
    return np.where(path.known, sigmas, np.nan)


def _against_each_other(chain: OdometryChain, judged: Sequence[Link], trusted: Sequence[Link]) -> list[Array]:
    """For each judged loop the sigmas (M,) between it and loops near by: along one, and along the path to the other."""
    pairs = _near(judged, trusted)
    if not len(pairs):
        return [np.zeros(0) for _ in judged]
    a, b = [judged[i] for i in pairs[:, 0]], [trusted[k] for k in pairs[:, 1]]
    out = chain.relative((link.from_id for link in a), (link.from_id for link in b))
    back = chain.relative((link.to_id for link in b), (link.to_id for link in a))
    T_b, known = _transforms(b), out.known & back.known
    # Errors on the way, carried to the end of the way.
    covariance = _covariances(a) + back.covariance
    covariance += _carried(_covariances(b), back.T_a_b) + _carried(out.covariance, T_b @ back.T_a_b)
    sigmas = _sigmas(_transforms(a), out.T_a_b @ T_b @ back.T_a_b, covariance)
    return [sigmas[(pairs[:, 0] == i) & known] for i in range(len(judged))]


def _near(judged: Sequence[Link], trusted: Sequence[Link]) -> NDArray[np.int64]:
    """Rows (N, 2) of (judged, trusted): the loops whose ends are nearest along the paths, by ids."""
    ends = np.array([link.pair for link in trusted], np.int64).reshape(-1, 2)
    rows = []
    for i, link in enumerate(judged):
        far = np.abs(ends - np.array(link.pair)).sum(axis=1)
        nearest = np.argsort(far, kind="stable")[: _NEIGHBORS + 1]
        rows += [(i, int(k)) for k in nearest if far[k] > 0][:_NEIGHBORS]
    return np.array(rows, np.int64).reshape(-1, 2)


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


def _transforms(loops: Sequence[Link]) -> Array:
    return np.array([link.T_from_to for link in loops]).reshape(-1, 4, 4)


def _covariances(loops: Sequence[Link]) -> Array:
    return np.linalg.inv(np.array([link.information for link in loops]).reshape(-1, 6, 6))
