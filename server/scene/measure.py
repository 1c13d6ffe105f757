"""How large things are drawn on a map of this size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: How far a camera is taken to see all around a path; on maps of whole quarters that does not matter.
_SIGHT_M = 2.0
#: Extent, metres, from which the ground has lines every ten metres.
_WIDE_M = 60.0


@dataclass(frozen=True, slots=True)
class Measure:
    """Lengths in metres.

    Attributes:
        extent: diagonal of the floor that is seen from the path.
        node: radius of a node.
        frustum: size of a camera's frustum.
        dash: length of a dash.
        cell: distance of the lines on the ground.
    """

    extent: float
    node: float
    frustum: float
    dash: float
    cell: float

    @classmethod
    def of(cls, positions: NDArray[np.float64]) -> Measure:
        """Sizes for a path through positions (N, 3): seen as a whole, yet no node hides its neighbours."""
        spread = np.ptp(positions[:, :2], axis=0) if len(positions) else np.zeros(2)
        extent = float(np.hypot(*spread)) + 2.0 * _SIGHT_M
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        gap = float(np.median(steps)) if len(steps) else extent
        node = float(np.clip(0.3 * gap, 0.0032 * extent, 0.0065 * extent))
        return cls(extent, node, 3.5 * node, 0.01 * extent, 1.0 if extent < _WIDE_M else 10.0)
