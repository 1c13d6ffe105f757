"""Floor plans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class LocalGrid:
    """What one node says about the floor plan: cell centres (N, 2) float32 in its base frame, levelled, metres."""

    ground: NDArray[np.float32]
    obstacles: NDArray[np.float32]
    empty: NDArray[np.float32]
    cell_size: float
    view_point: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid:
    """A 2D map: ``cells`` (rows = y, columns = x) int8, -1 unknown, 0 free, 100 occupied.

    Cell (row, col) has its lower left corner at x_min + col * cell_size, y_min + row * cell_size, in the map frame.
    """

    cells: NDArray[np.int8]
    x_min: float
    y_min: float
    cell_size: float
