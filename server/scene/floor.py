"""The ground: where it is, the lines on it, and the occupancy grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.colours import Theme
from server.scene.tone import for_line
from server.schemas.scene import GridLook
from slam.types import OccupancyGrid

if TYPE_CHECKING:
    from viser import GridHandle, ImageHandle, SceneApi

#: A floor is somewhere within this below the path; what lies deeper is a reflection or a stairwell.
_DEEPEST_M = 2.5
#: Differences of height that are worth moving the ground for.
_STEP_M = 0.05
#: The image of a grid has at least this many pixels along its longer side, so that cells stay crisp; while it changes
#: many times a second, fewer.
_SHARP_PX, _QUICK_PX = 1500, 500
_FREE_ALPHA = 120
_OCCUPIED_ALPHA = 235
#: Percent from which a cell is drawn as occupied.
_OCCUPIED = 50


class FloorLayer:
    """Lines on the ground and, as a layer, the occupancy grid just above them."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._height: float | None = None
        self._ground: GridHandle | None = None
        self._image: ImageHandle | None = None
        self._drawn: tuple[OccupancyGrid, Theme, bool, GridLook] | None = None

    @property
    def height(self) -> float:
        """Of the ground that is shown, metres; 0 before it is."""
        return self._height or 0.0

    def draw_ground(self, height: float, cell: float, extent: float, look: Theme) -> None:
        """Show the lines, ``cell`` metres apart, at about this height."""
        if self._height is None or abs(height - self._height) > _STEP_M:
            self._height = height
        if self._ground is None:
            self._ground = self._scene.add_grid("/ground", infinite_grid=True, plane="xy", shadow_opacity=0.0)
        ground = self._ground
        ground.position = np.array([0.0, 0.0, self._height])
        ground.cell_size, ground.section_size = cell, 5.0 * cell
        ground.cell_thickness, ground.section_thickness = 0.7, 1.0
        ground.fade_distance = 4.0 * max(extent, 10.0 * cell)
        ground.fade_strength = 1.5
        ground.cell_color, ground.section_color = (for_line(rgb) for rgb in look.ground)
        self._place_image()

    def draw_grid(
        self,
        grid: OccupancyGrid | None,
        look: Theme,
        *,
        visible: bool,
        sharp: bool = True,
        how: GridLook = "plan",
    ) -> None:
        """Show the occupancy grid; its image is made only when it is to be seen and has changed.

        One that is about to change again need not be ``sharp``.
        """
        if grid is None or not grid.cells.size:
            visible = False
        elif visible and not self._is_drawn(grid, look, sharp, how):
            self._show_image(grid, look, sharp, how)
        if self._image is not None:
            self._image.visible = visible

    def _is_drawn(self, grid: OccupancyGrid, look: Theme, sharp: bool, how: GridLook) -> bool:
        if self._drawn is None or self._drawn[1] is not look or self._drawn[2] < sharp or self._drawn[3] != how:
            return False
        old = self._drawn[0]
        same_place = (old.x_min, old.y_min, old.cell_size) == (grid.x_min, grid.y_min, grid.cell_size)
        return same_place and np.array_equal(old.cells, grid.cells)

    def _show_image(self, grid: OccupancyGrid, look: Theme, sharp: bool, how: GridLook) -> None:
        rows, columns = grid.cells.shape
        width, height = columns * grid.cell_size, rows * grid.cell_size
        image = grid_image(grid, look, _SHARP_PX if sharp else _QUICK_PX, how)
        if self._image is None:
            self._image = self._scene.add_image(
                "/grid", image, width, height, format="png", cast_shadow=False, receive_shadow=False
            )
        else:
            self._image.image = image
            self._image.render_width, self._image.render_height = width, height
        self._drawn = (grid, look, sharp, how)
        self._place_image()

    def _place_image(self) -> None:
        if self._image is None or self._drawn is None or self._height is None:
            return
        grid = self._drawn[0]
        rows, columns = grid.cells.shape
        middle = (grid.x_min + 0.5 * columns * grid.cell_size, grid.y_min + 0.5 * rows * grid.cell_size)
        # viser's images look along +z with the first row at -y, as OpenCV's do: half a turn about x lays them face up.
        self._image.wxyz = np.array([0.0, 1.0, 0.0, 0.0])
        self._image.position = np.array([*middle, self._height + 0.01])


def grid_image(
    grid: OccupancyGrid, look: Theme, least_px: int = _SHARP_PX, how: GridLook = "plan"
) -> NDArray[np.uint8]:
    """The grid as seen from above, y upwards: (H, W, 4) red, green, blue, opacity; about ``least_px`` on a side."""
    cells = grid.cells[::-1]
    if how == "probability":
        palette, kind = _shades(look), cells.clip(-1, 100).astype(np.int64) + 1
    else:
        palette = np.zeros((4, 4), dtype=np.uint8)
        palette[1] = (*look.free, _FREE_ALPHA)
        palette[2] = (*look.occupied, _OCCUPIED_ALPHA)
        palette[3] = (*look.frontier, _OCCUPIED_ALPHA)
        kind = (cells >= 0).astype(np.int64) + (cells >= _OCCUPIED)
        if how == "frontiers":
            kind[frontiers(cells)] = 3
    factor = max(1, least_px // max(grid.cells.shape))
    # One number for each pixel: four times as fast as four.
    image = palette.view(np.uint32)[kind, 0].repeat(factor, axis=0).repeat(factor, axis=1)
    return np.ascontiguousarray(image).view(np.uint8).reshape(*image.shape, 4)


def frontiers(cells: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Free cells (rows, columns) with an unknown one at a side of them: where a robot would learn more."""
    unknown = np.pad(cells < 0, 1, constant_values=False)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    return np.asarray((cells >= 0) & (cells < _OCCUPIED) & beside)


def _shades(look: Theme) -> NDArray[np.uint8]:
    """Colours (102, 4) of unknown and of 0 to 100 percent."""
    share = np.linspace(0.0, 1.0, 101)[:, None]
    ends = np.array([[*look.free, _FREE_ALPHA], [*look.occupied, _OCCUPIED_ALPHA]], np.float64)
    shades = np.rint((1.0 - share) * ends[0] + share * ends[1]).astype(np.uint8)
    return np.ascontiguousarray(np.vstack([np.zeros((1, 4), np.uint8), shades]))


def floor_height(positions: NDArray[np.float64], points: NDArray[np.float64]) -> float:
    """Height of the floor in metres: where the lowest of the points (M, 3) gather below the path (N, 3).

    Without points, the path is taken for that of a robot on the floor.
    """
    lowest = float(np.percentile(positions[:, 2], 5)) if len(positions) else 0.0
    heights = points[:, 2][(points[:, 2] < lowest) & (points[:, 2] > lowest - _DEEPEST_M)]
    if len(heights) < max(20, 0.02 * len(points)):
        return lowest - 0.02
    return float(np.percentile(heights, 4))
