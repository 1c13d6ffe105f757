"""The floor is below the path, the grid lies on it the right way round."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from server.scene.colours import DARK, LIGHT
from server.scene.floor import FloorLayer, floor_height, frontiers, grid_image
from slam.types import OccupancyGrid
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import GRID


def test_the_floor_is_where_points_gather_below_the_path_and_stray_points_do_not_count() -> None:
    rng = np.random.default_rng(0)
    floor = np.column_stack([rng.uniform(-5, 5, (4000, 2)), rng.normal(-1.2, 0.01, 4000)])
    walls = np.column_stack([rng.uniform(-5, 5, (4000, 2)), rng.uniform(-1.2, 0.9, 4000)])
    stray = np.column_stack([rng.uniform(-5, 5, (40, 2)), rng.uniform(-9, -3, 40)])
    path = np.column_stack([np.linspace(0, 5, 50), np.zeros(50), rng.normal(0, 0.05, 50)])
    assert floor_height(path, np.vstack([floor, walls, stray])) == pytest.approx(-1.2, abs=0.05)


def test_without_points_the_path_is_on_the_floor() -> None:
    path = np.column_stack([np.linspace(0, 5, 50), np.zeros((50, 2))])
    assert floor_height(path, np.zeros((0, 3))) == pytest.approx(0.0, abs=0.05)
    assert floor_height(np.zeros((0, 3)), np.zeros((0, 3))) == pytest.approx(0.0, abs=0.05)


def test_the_image_is_seen_from_above_with_y_upwards() -> None:
    image = grid_image(GRID, LIGHT)
    height, width = image.shape[:2]
    assert height / width == 2 / 3
    free, occupied, unknown = image[0, width // 2], image[0, 0], image[0, -1]
    assert tuple(free[:3]) == LIGHT.free
    assert tuple(occupied[:3]) == LIGHT.occupied
    assert unknown[3] == 0 < free[3] < occupied[3]
    assert tuple(image[-1, 0]) == tuple(free)


@given(
    hnp.arrays(np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=9), elements=st.sampled_from([-1, 0, 100]))
)
def test_a_frontier_is_a_free_cell_beside_the_unknown(cells: NDArray[np.int8]) -> None:
    found = frontiers(cells)
    for (row, column), value in np.ndenumerate(cells):
        beside = [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
        inside = [at for at in beside if 0 <= at[0] < cells.shape[0] and 0 <= at[1] < cells.shape[1]]
        assert found[row, column] == (value == 0 and any(cells[at] < 0 for at in inside))


def test_frontiers_and_probabilities_have_colours_of_their_own() -> None:
    cells = np.array([[0, 0, -1], [100, 30, 80]], np.int8)
    grid = OccupancyGrid(cells, 0.0, 0.0, 0.5)
    image = grid_image(grid, DARK, 3, "frontiers")[::-1]
    assert [tuple(image[0, k, :3]) for k in (0, 1)] == [DARK.free, DARK.frontier]
    assert image[0, 2, 3] == 0 and tuple(image[1, 0, :3]) == DARK.occupied
    shades = grid_image(grid, DARK, 3, "probability")[::-1]
    assert tuple(shades[0, 0, :3]) == DARK.free and tuple(shades[1, 0, :3]) == DARK.occupied and shades[0, 2, 3] == 0
    assert DARK.free[0] < shades[1, 1, 0] < shades[1, 2, 0] < DARK.occupied[0]


def test_the_grid_lies_where_its_cells_are(viewer: Any) -> None:
    layer = FloorLayer(viewer.scene)
    layer.draw_grid(GRID, DARK, visible=True)
    layer.draw_ground(-1.2, 1.0, 10.0, DARK)
    image = viewer.scene.get_handle_by_name("/grid")
    assert (image.render_width, image.render_height) == (1.5, 1.0)
    np.testing.assert_allclose(image.position, [-0.25, 0.0, -1.19])


def test_an_image_is_made_only_when_it_is_seen_and_has_changed(viewer: Any, sent: Sent) -> None:
    layer = FloorLayer(viewer.scene)
    layer.draw_ground(0.0, 1.0, 10.0, DARK)
    layer.draw_grid(GRID, DARK, visible=False)
    layer.draw_grid(None, DARK, visible=True)
    assert "Image" not in {kind for kind, _ in sent.take()}
    layer.draw_grid(GRID, DARK, visible=True)
    assert ("Image", "/grid") in sent.take()
    same = OccupancyGrid(GRID.cells.copy(), GRID.x_min, GRID.y_min, GRID.cell_size)
    layer.draw_grid(same, DARK, visible=True)
    assert sent.take() == []
    for grid, look in ((same, LIGHT), (OccupancyGrid(GRID.cells[:1], -1.0, -0.5, 0.5), LIGHT)):
        layer.draw_grid(grid, look, visible=True)
        assert {name for _, name in sent.take()} >= {"/grid"}


def test_an_image_that_changes_fast_is_drawn_sharp_when_it_stays(viewer: Any, sent: Sent) -> None:
    layer = FloorLayer(viewer.scene)
    layer.draw_grid(GRID, DARK, visible=True, sharp=False)
    coarse = len(viewer.scene.get_handle_by_name("/grid").image)
    layer.draw_grid(GRID, DARK, visible=True)
    assert len(viewer.scene.get_handle_by_name("/grid").image) > 2 * coarse
    sent.take()
    layer.draw_grid(GRID, DARK, visible=True, sharp=False)
    assert sent.take() == []


def test_the_ground_does_not_tremble(viewer: Any, sent: Sent) -> None:
    layer = FloorLayer(viewer.scene)
    layer.draw_ground(-1.2, 1.0, 10.0, DARK)
    sent.take()
    layer.draw_ground(-1.21, 1.0, 10.0, DARK)
    assert sent.take() == []
    layer.draw_ground(-1.6, 1.0, 10.0, DARK)
    assert sent.take() == [("SetPosition", "/ground")]
