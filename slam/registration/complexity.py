"""How much of a motion a scan's surfaces fix: all of it in a corner, little of it on a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, between, make, so3_exp, so3_log, transform

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Complexity:
    """The directions of a scan's surfaces.

    Attributes:
        shares: (3,) share of the surfaces that faces each direction, times 3, descending: 3 0 0 for one plane,
            1 1 1 for surfaces in all directions alike.
        directions: (3, 3) the unit directions, one a column.
    """

    shares: Array
    directions: Array

    @property
    def value(self) -> float:
        """The least share: 0 when some motion is not seen at all, 1 at most."""
        return float(self.shares[2])


def complexity(normals: Array) -> Complexity:
    """Structural complexity of unit normals (N, 3): principal components of the normals and their opposites."""
    if len(normals) == 0:
        return Complexity(np.zeros(3), np.eye(3))
    shares, directions = np.linalg.eigh(3.0 * normals.T @ normals / len(normals))
    return Complexity(np.clip(shares[::-1], 0.0, None), np.ascontiguousarray(directions[:, ::-1]))


def limited(T_from_to: Pose, guess: Pose, seen: Complexity, least: float, points_to: Array) -> Pose:
    """A correction of a guess, without the part that the surfaces don't fix.

    Shifts stay along directions that surfaces face; on a single plane the turn about its normal goes too. The
    correction is split into shift and turn about the middle of the points, where the two hardly mix.

    Args:
        T_from_to: (4, 4) corrected.
        guess: (4, 4) before.
        seen: directions of the surfaces, in the first frame.
        least: share from which a direction counts as seen.
        points_to: (N, 3) of the second scan, in its own frame.
    """
    fixed = seen.directions[:, seen.shares >= least]
    middle = np.asarray(transform(guess, points_to.mean(axis=0)[np.newaxis])[0])
    correction = T_from_to @ between(guess, np.eye(4))
    shift = correction[:3, :3] @ middle + correction[:3, 3] - middle
    turn = so3_log(correction[:3, :3])
    if fixed.shape[1] == 1:
        turn = turn - fixed[:, 0] * (fixed[:, 0] @ turn)
    R = so3_exp(turn)
    t = middle + fixed @ (fixed.T @ shift) - R @ middle
    return np.asarray(make(R, t) @ guess)
