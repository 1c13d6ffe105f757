"""Perceptual aliasing: other places that look like the one that a loop leads to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from slam.geometry import Array, Pose, between, rotation_angle, translation_norm
from slam.types import Posterior

#: Nodes nearer than both see the same place.
_ELSEWHERE_M = 2.0
_ELSEWHERE_RAD = float(np.radians(60.0))
#: From this share of the loop's own place on, another one is as good as it.
NEARLY = 0.8


@dataclass(frozen=True, slots=True)
class LookAlike:
    """The place that rivals another one most.

    Attributes:
        node_id: of the rival.
        distance_m: between both places in the optimised map.
        share: of the place's likelihood (above that of a chance match) or posterior, whichever is the larger share.
    """

    node_id: int
    distance_m: float
    share: float


def look_alike(belief: Posterior, place_id: int, poses: Mapping[int, Pose]) -> LookAlike | None:
    """The rival of a place elsewhere in the map; None where the belief does not hold the place, or no place elsewhere.

    Args:
        belief: of one update; its adjusted likelihoods are 1 for places that look no more alike than by chance.
        place_id: the place that the loop leads to.
        poses: id -> (4, 4) ``T_map_base``.
    """
    here = np.flatnonzero(belief.node_ids == place_id)
    if not len(here) or place_id not in poses:
        return None
    shares = np.maximum(
        _shares(belief.probability, int(here[0])), _shares(np.maximum(belief.likelihood - 1.0, 0.0), int(here[0]))
    )
    for row in np.argsort(-shares, kind="stable"):
        node_id = int(belief.node_ids[row])
        if node_id in poses:
            T = between(poses[place_id], poses[node_id])
            distance = translation_norm(T)
            if distance > _ELSEWHERE_M or rotation_angle(T) > _ELSEWHERE_RAD:
                return LookAlike(node_id, distance, float(shares[row]))
    return None


def _shares(values: Array, here: int) -> Array:
    """Values (N,) by the one that counts; 0 where that one is nothing."""
    return values / values[here] if values[here] > 0 else np.zeros(len(values))
