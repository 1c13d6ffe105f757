"""What odometry alone says of two places: the transform along its path, and how sure that is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, adjoint, inverse
from slam.graph.graph import PoseGraph, ascending
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
        self._path: dict[int, int] = {}
        self._row: dict[int, int] = {}
        poses: list[Array] = []
        sums: list[Array] = []
        for node_id in sorted(graph.poses):
            step = _step_from(graph, node_id, self._path)
            T_path_node, total, self._path[node_id] = np.eye(4), np.zeros((6, 6)), node_id
            if step is not None:
                before, T_before_node, covariance = step
                row = self._row[before]
                T_path_node = poses[row] @ T_before_node
                Ad = adjoint(T_path_node)
                total = sums[row] + Ad @ covariance @ Ad.T
                self._path[node_id] = self._path[before]
            self._row[node_id] = len(poses)
            poses.append(T_path_node)
            sums.append(total)
        self._poses, self._sums = np.array(poses).reshape(-1, 4, 4), np.array(sums).reshape(-1, 6, 6)

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


def _step_from(graph: PoseGraph, node_id: int, earlier: dict[int, int]) -> tuple[int, Array, Array] | None:
    """The nearest earlier node that odometry joins with this one, the step from there and its covariance."""
    links = graph.neighbors(node_id)
    steps = (i for i, link in links.items() if i in earlier and link.type in _STEPS and is_sound(link))
    before = max(steps, default=None)
    if before is None:
        return None
    link = ascending(links[before])
    assert link.T_from_to is not None
    return before, link.T_from_to, np.linalg.inv(link.information).astype(np.float64)


def is_sound(link: Link) -> bool:
    """Whether a link's transform and covariance can be reckoned with: files of other programs hold anything."""
    if link.T_from_to is None or not (np.isfinite(link.T_from_to).all() and np.isfinite(link.information).all()):
        return False
    return bool(np.linalg.eigvalsh(link.information)[0] > 0.0)
