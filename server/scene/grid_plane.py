"""The occupancy grid as a picture on the floor."""

from __future__ import annotations

import numpy as np
import viser
from numpy.typing import NDArray

from slam.types import OccupancyGrid

#: Red, green, blue, opacity; unknown cells are seen through.
_FREE = (120, 150, 185, 70)
_OCCUPIED = (245, 166, 60, 235)
_LIFT_METRES = 0.01


class GridPlane:
    """Draws the grid; a new picture is sent when its cells changed."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._handle: viser.ImageHandle | None = None
        self._drawn: OccupancyGrid | None = None
        self._height = 0.0

    def draw(self, grid: OccupancyGrid | None, height: float, *, visible: bool) -> None:
        """Show a grid at the height of the floor."""
        if grid is None or not visible:
            if self._handle is not None:
                self._handle.visible = False
            return
        if self._handle is None or height != self._height or not _same(grid, self._drawn):
            self._handle = self._add(grid, height)
            self._drawn, self._height = grid, height
        self._handle.visible = True

    def _add(self, grid: OccupancyGrid, height: float) -> viser.ImageHandle:
        rows, columns = grid.cells.shape
        width, depth = columns * grid.cell_size, rows * grid.cell_size
        return self._server.scene.add_image(
            "/grid",
            picture(grid),
            width,
            depth,
            format="png",
            cast_shadow=False,
            receive_shadow=False,
            # An image shows its first row on top and looks at -z; turned about x it lies on the floor, y up the rows.
            wxyz=(0.0, 1.0, 0.0, 0.0),
            position=(grid.x_min + width / 2, grid.y_min + depth / 2, height + _LIFT_METRES),
        )


def picture(grid: OccupancyGrid) -> NDArray[np.uint8]:
    """The grid as an RGBA image, one pixel for each cell, rows upwards as y."""
    image = np.zeros((*grid.cells.shape, 4), dtype=np.uint8)
    image[grid.cells == 0] = _FREE
    image[grid.cells > 0] = _OCCUPIED
    return image


def _same(a: OccupancyGrid, b: OccupancyGrid | None) -> bool:
    return b is not None and (a.x_min, a.y_min) == (b.x_min, b.y_min) and np.array_equal(a.cells, b.cells)
