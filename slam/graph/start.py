"""The values an optimisation starts from, and those of the last ones: a map grows by a node at a time."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import gtsam
import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, Pose, make
from slam.graph.factors import landmark_key
from slam.graph.problem import Problem, orthonormal
from slam.graph.spaces import SPATIAL, Space


@dataclass(frozen=True, slots=True, eq=False)
class _Known:
    """GTSAM's values (poses only) and the same as arrays: ids (N,) ascending, poses (N, 4, 4)."""

    ids: NDArray[np.int64]
    T: Array
    values: gtsam.Values


class Starts:
    """Makes GTSAM's values of poses; copying them is forty times faster than putting them together one by one.

    What is copied is the same to the last bit. Where the last optimisation began is known too: if its loops were
    refused, the next one begins there again.
    """

    def __init__(self) -> None:
        self._known: deque[_Known] = deque(maxlen=2)

    def values(self, problem: Problem, space: Space) -> gtsam.Values:
        """Where all poses and landmarks of a problem start."""
        T = space.flat(orthonormal(np.array([problem.poses[i] for i in problem.ids])))
        values = self._poses(np.array(problem.ids, np.int64), T, space)
        if not problem.sightings:
            self._remember(np.array(problem.ids, np.int64), T, gtsam.Values(values), space)
        oriented = problem.oriented()
        for landmark_id in problem.landmark_ids:
            T_map_landmark = orthonormal(problem.poses[landmark_id])
            whole = space.value(T_map_landmark) if landmark_id in oriented else T_map_landmark[space.linear, 3]
            values.insert(landmark_key(landmark_id), whole)
        return values

    def poses(self, problem: Problem, space: Space, solved: gtsam.Values) -> dict[int, Pose]:
        """Poses of nodes and, by their negative ids, of landmarks; one without orientation has that of the map."""
        oriented = problem.oriented()
        ids = [*problem.ids, *(i for i in problem.landmark_ids if i in oriented)]
        points = [i for i in problem.landmark_ids if i not in oriented]
        T = space.poses(without(solved, [landmark_key(i) for i in points]))
        if not problem.sightings:
            self._remember(np.array(ids, np.int64), T, solved, space)
        found = dict(zip(ids, T.copy(), strict=True))
        return found | {i: make(np.eye(3), space.point(solved, landmark_key(i))) for i in points}

    def _poses(self, ids: NDArray[np.int64], T: Array, space: Space) -> gtsam.Values:
        if space is not SPATIAL:
            return _filled(gtsam.Values(), ids, T, space)
        for known in tuple(self._known):
            rows = np.searchsorted(ids, known.ids)
            if rows[-1] >= len(ids) or not np.array_equal(ids[rows], known.ids):
                continue
            new = np.ones(len(ids), dtype=bool)
            new[rows] = False
            moved = rows[(T[rows] != known.T).any(axis=(1, 2))]
            if len(moved) < len(ids) // 4:
                start = gtsam.Values(known.values)
                for row in moved:
                    start.update(ids[row], space.value(T[row]))
                return _filled(start, ids[new], T[new], space)
        return _filled(gtsam.Values(), ids, T, space)

    def _remember(self, ids: NDArray[np.int64], T: Array, values: gtsam.Values, space: Space) -> None:
        if space is SPATIAL:
            self._known.appendleft(_Known(ids, T, values))


def without(values: gtsam.Values, keys: Iterable[int]) -> gtsam.Values:
    """A copy without these: GTSAM's extractPose3 reads beyond its memory where values hold points too."""
    rest = gtsam.Values(values)
    for key in keys:
        rest.erase(key)
    return rest


def _filled(values: gtsam.Values, ids: NDArray[np.int64], T: Array, space: Space) -> gtsam.Values:
    for node_id, T_map_base in zip(ids.tolist(), T, strict=True):
        values.insert(node_id, space.value(T_map_base))
    return values
