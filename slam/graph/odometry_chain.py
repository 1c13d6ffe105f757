"""What odometry alone says of two places: the transform along its path, and how sure that is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, adjoint, inverse
from slam.graph.graph import Pair, PoseGraph, all_ascending
from slam.types import Link, LinkType

_STEPS = (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED)


@dataclass(frozen=True, slots=True, eq=False)
class Relative:
    """Transforms between pairs of nodes along odometry's path.

    Attributes:
        T_a_b: (N, 4, 4), the identity where no path leads from a to b.
        covariance: (N, 6, 6) in axes of b, x y z roll pitch yaw, m^2 and rad^2.
        known: (N,) whether odometry joins the two.
    """

    T_a_b: Array
    covariance: Array
    known: NDArray[np.bool_]


class OdometryChain:
    """The paths that neighbour links make, with sums of covariances that make any stretch of them cheap.

    A step's error is carried to the frame in which its path begins, where errors of steps add up (Barfoot 2017,
    equation 7.284 to first order), so that a stretch is the difference of two sums.
    """

    def __init__(self, graph: PoseGraph) -> None:
        steps = _steps(graph)
        ids = sorted(graph.poses)
        self._row = {node_id: row for row, node_id in enumerate(ids)}
        self._path: dict[int, int] = {}
        self._poses = np.tile(np.eye(4), (len(ids), 1, 1))
        before = np.full(len(ids), -1)
        covariances = np.zeros((len(ids), 6, 6))
        for row, node_id in enumerate(ids):
            # The nearest earlier node that odometry joins with this one.
            nearest = max((i for i in graph.neighbors(node_id) if (i, node_id) in steps), default=None)
            self._path[node_id] = node_id if nearest is None else self._path[nearest]
            if nearest is not None:
                T_before_node, covariances[row] = steps[nearest, node_id]
                before[row] = self._row[nearest]
                self._poses[row] = self._poses[before[row]] @ T_before_node
        Ad = adjoint(self._poses)
        self._sums = Ad @ covariances @ np.swapaxes(Ad, 1, 2)
        for row in np.flatnonzero(before >= 0).tolist():
            self._sums[row] += self._sums[before[row]]

    def relative(self, a: Iterable[int], b: Iterable[int]) -> Relative:
        """From nodes a (N,) to nodes b (N,); ids that the graph has."""
        a, b = list(a), list(b)
        rows_a, rows_b = ([self._row[i] for i in ids] for ids in (a, b))
        known = np.array([self._path[i] == self._path[j] for i, j in zip(a, b, strict=True)], np.bool_)
        T_path_b = self._poses[rows_b]
        # Errors of the steps between them are the same whichever way one goes.
        difference = self._sums[rows_b] - self._sums[rows_a]
        later = np.array(rows_b) >= np.array(rows_a)
        difference = np.where(later[:, None, None], difference, -difference)
        Ad = adjoint(inverse(T_path_b))
        covariance = Ad @ difference @ np.swapaxes(Ad, 1, 2)
        T_a_b = np.where(known[:, None, None], inverse(self._poses[rows_a]) @ T_path_b, np.eye(4))
        return Relative(T_a_b, 0.5 * (covariance + np.swapaxes(covariance, 1, 2)), known)


def _steps(graph: PoseGraph) -> dict[Pair, tuple[Array, Array]]:
    """Transform and covariance of every step of odometry, from its smaller id."""
    links = sound([link for link in graph.links.values() if link.type in _STEPS])
    T, covariances = transforms(links), np.linalg.inv(informations(links))
    return {link.pair: (T[k], covariances[k]) for k, link in enumerate(links)}


def sound(links: Iterable[Link]) -> list[Link]:
    """Those whose transform and covariance can be reckoned with (files of other programs hold anything), ascending."""
    finite = [
        link
        for link in links
        if link.T_from_to is not None and np.isfinite(link.T_from_to).all() and np.isfinite(link.information).all()
    ]
    positive = np.linalg.eigvalsh(informations(finite))[:, 0] > 0.0
    return all_ascending([link for link, good in zip(finite, positive, strict=True) if good])


def transforms(links: Sequence[Link]) -> Array:
    """(N, 4, 4) of links that have one."""
    return np.array([link.T_from_to for link in links]).reshape(-1, 4, 4)


def informations(links: Sequence[Link]) -> Array:
    """(N, 6, 6)."""
    return np.array([link.information for link in links], np.float64).reshape(-1, 6, 6)
