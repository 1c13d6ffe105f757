"""What odometry alone says of two places: the transform along its path, and how sure that is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slam.geometry import Array, adjoint, inverse
from slam.graph.graph import PoseGraph, all_ascending
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
        self._ids = np.array(sorted(graph.poses), np.int64)
        before, T_before_node, covariances = _steps(graph, self._ids)
        # The row in which each path begins.
        self._path = np.arange(len(before))
        self._poses = np.tile(np.eye(4), (len(before), 1, 1))
        joined = np.flatnonzero(before >= 0)
        for row, nearest in zip(joined.tolist(), before[joined].tolist(), strict=True):
            self._path[row] = self._path[nearest]
            np.matmul(self._poses[nearest], T_before_node[row], out=self._poses[row])
        Ad = adjoint(self._poses)
        self._sums = Ad @ covariances @ np.swapaxes(Ad, 1, 2)
        for row, nearest in zip(joined.tolist(), before[joined].tolist(), strict=True):
            self._sums[row] += self._sums[nearest]

    def relative(self, a: ArrayLike, b: ArrayLike) -> Relative:
        """From nodes a (N,) to nodes b (N,); ids that the graph has."""
        rows_a, rows_b = (np.searchsorted(self._ids, ids) for ids in (a, b))
        known = self._path[rows_a] == self._path[rows_b]
        T_path_b = self._poses[rows_b]
        # Errors of the steps between them are the same whichever way one goes.
        difference = self._sums[rows_b] - self._sums[rows_a]
        difference = np.where((rows_b >= rows_a)[:, None, None], difference, -difference)
        Ad = adjoint(inverse(T_path_b))
        covariance = Ad @ difference @ np.swapaxes(Ad, 1, 2)
        T_a_b = np.where(known[:, None, None], inverse(self._poses[rows_a]) @ T_path_b, np.eye(4))
        return Relative(T_a_b, 0.5 * (covariance + np.swapaxes(covariance, 1, 2)), known)


def _steps(graph: PoseGraph, ids: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array, Array]:
    """Of each node the step of odometry that leads to it: from the nearest earlier node that has one.

    Returns:
        Row (N,) of that node in ``ids``, -1 without a step; transform (N, 4, 4) and covariance (N, 6, 6) of the step.
    """
    links = sound([link for link in graph.links.values() if link.type in _STEPS])
    rows = np.searchsorted(ids, np.array([link.pair for link in links], np.int64).reshape(-1, 2))
    # Of several steps to a node the one written last stays: from the largest id.
    order = np.argsort(rows[:, 0])
    earlier, later = rows[order].T
    before, T, covariances = np.full(len(ids), -1), np.zeros((len(ids), 4, 4)), np.zeros((len(ids), 6, 6))
    before[later], T[later] = earlier, transforms(links)[order]
    covariances[later] = np.linalg.inv(informations(links))[order]
    return before, T, covariances


def sound(links: Iterable[Link]) -> list[Link]:
    """Those whose transform and covariance can be reckoned with (files of other programs hold anything), ascending."""
    given = [link for link in links if link.T_from_to is not None]
    stack = informations(given)
    good: NDArray[np.bool_] = np.asarray(np.isfinite(transforms(given)).all(axis=(1, 2)))
    good &= np.isfinite(stack).all(axis=(1, 2))
    good[good] = np.linalg.eigvalsh(stack[good])[:, 0] > 0.0
    return all_ascending([given[row] for row in np.flatnonzero(good)])


def transforms(links: Sequence[Link]) -> Array:
    """(N, 4, 4) of links that have one."""
    return np.array([link.T_from_to for link in links]).reshape(-1, 4, 4)


def informations(links: Sequence[Link]) -> Array:
    """(N, 6, 6)."""
    return np.array([link.information for link in links], np.float64).reshape(-1, 6, 6)
