"""What holds a map in its place: the root's pose, as far as nothing else does."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array, Pose
from slam.graph.problem import Problem, knows_rotation

_HELD = 1e12
#: Beside directions that are free; more than this and both can't be told apart in double precision.
_HELD_BESIDE_FREE = 1e8
#: Holds nothing that a measurement says otherwise, but leaves no direction without any information.
_FREE = 1e-5


def gauge(problem: Problem, T_map_root: Pose) -> Array:
    """Information (6, 6) of the root's pose, translation first, in its own frame.

    With priors the whole map moves to where they say; with gravity it tilts, and only position and heading are held. A
    single position says nothing of how the map is turned: that is held.
    """
    priors = problem.priors
    if len(priors) > 1 or any(knows_rotation(prior) for prior in priors):
        return _FREE * np.eye(6)
    if not (priors or problem.gravity):
        return _HELD * np.eye(6)
    information, up_base = _HELD_BESIDE_FREE * np.eye(6), T_map_root[2, :3]
    if problem.gravity:
        information[3:, 3:] = (_HELD_BESIDE_FREE - _FREE) * np.outer(up_base, up_base) + _FREE * np.eye(3)
    if priors:
        information[:3, :3] = _FREE * np.eye(3)
    return information


def is_held(problem: Problem) -> bool:
    """Whether the root stays where it was."""
    return not (problem.priors or problem.gravity)
