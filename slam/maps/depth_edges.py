"""Pixels of depth images at the edges of things, which hang in the air between two surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: A step of depth, as a share of the depth, that no floor makes: points at such edges hang in the air.
_JUMP = 0.07


def without_edges(depth_m: NDArray[np.float32], step: int = 1) -> NDArray[np.float32]:
    """Depth (H, W) whose every ``step``-th pixel is 0 where a neighbour among these is much nearer or farther."""
    kept = depth_m.copy()
    seen, used = depth_m[::step, ::step], kept[::step, ::step]
    for one, other in ((seen[1:], seen[:-1]), (seen[:, 1:], seen[:, :-1])):
        jump = np.abs(one - other) > _JUMP * np.minimum(one, other)
        jump &= (one > 0) & (other > 0)
        rows, columns = jump.shape
        used[-rows:, -columns:][jump] = 0.0
        used[:rows, :columns][jump] = 0.0
    return kept
