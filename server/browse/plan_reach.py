"""How far the pictures of scans and local grids reach."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slam.types import LocalGrid


def grid_reach(grid: LocalGrid) -> float:
    """Half of the side of the picture of a grid, metres: the middle of the base's own cell to the outermost edge."""
    farthest = max(float(np.abs(cells).max(initial=0.0)) for cells in (grid.ground, grid.obstacles, grid.empty))
    return (math.ceil(farthest / grid.cell_size) + 0.5) * grid.cell_size


def scan_reach(points_base: NDArray[np.floating]) -> float:
    """Half of the side of the picture of a scan with points (N, 3), metres."""
    return max(0.5, 1.03 * float(np.abs(points_base[:, :2]).max(initial=0.0)))


def cell_count(grid: LocalGrid) -> int:
    """Cells of all three kinds."""
    return len(grid.ground) + len(grid.obstacles) + len(grid.empty)
