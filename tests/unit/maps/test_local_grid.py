"""Local grids of a rendered room: ground is ground, walls and tables are obstacles, whatever way the camera tilts."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, to_euler_rpy
from slam.maps.local_grid import level, make_local_grid, yaw
from slam.params import Params
from slam.types import LocalGrid
from tests.rooms import CAMERA, HEIGHT, TABLE, render, tilted

PARAMS = Params()
DOWN = tilted(pitch=0.35)


def make(T_map_base: Pose = DOWN, params: Params = PARAMS, **room: float) -> LocalGrid:
    return make_local_grid(render(T_map_base, **room), CAMERA, level(T_map_base), params)  # type: ignore[arg-type]


def among(cells: NDArray[np.float32], x: tuple[float, float], y: tuple[float, float]) -> NDArray[np.bool_]:
    return (cells[:, 0] > x[0]) & (cells[:, 0] < x[1]) & (cells[:, 1] > y[0]) & (cells[:, 1] < y[1])


def test_the_floor_is_ground_and_the_wall_an_obstacle() -> None:
    grid = make()
    assert len(grid.ground) > 1000
    assert grid.ground[:, 0].max() < 4.0
    assert len(grid.obstacles) > 50
    assert np.all(np.abs(grid.obstacles[:, 0] - 4.0) < 0.06)
    assert grid.view_point == (0.0, 0.0, 0.0)
    assert grid.cell_size == PARAMS.Grid.CellSize


def test_a_table_is_an_obstacle_although_it_is_flat() -> None:
    # A depth image of every pixel: with fewer, the floor shows through between the samples of the top.
    grid = make(params=PARAMS.changed({"Grid/DepthDecimation": 1}), table=True)
    x, y, _ = TABLE
    assert among(grid.obstacles, x, y).sum() == 16 * 16
    assert not among(grid.ground, x, y).any()
    assert len(grid.ground) > 500


def test_a_ceiling_is_no_obstacle() -> None:
    looking_up = tilted(pitch=-0.3)
    below, without = make(looking_up, ceiling=1.5), make(looking_up)
    assert np.all(np.abs(below.obstacles[:, 0] - 4.0) < 0.06)
    assert len(without.obstacles) > 0


@settings(max_examples=15, deadline=None)
@given(roll=st.floats(-0.4, 0.4), pitch=st.floats(0.2, 0.6), heading=st.floats(-0.3, 0.3))
def test_whatever_the_tilt_the_floor_plan_is_the_same(roll: float, pitch: float, heading: float) -> None:
    grid = make(tilted(roll, pitch, heading))
    c, s = np.cos(heading), np.sin(heading)
    x, y = (grid.obstacles @ np.array([[c, s], [-s, c]])).T
    assert len(grid.ground) > 500
    assert np.all((np.abs(np.abs(x) - 4.0) < 0.1) | (np.abs(np.abs(y) - 4.0) < 0.1))


def test_no_cell_is_two_things() -> None:
    grid = make(table=True)
    cells = [tuple(c) for part in (grid.ground, grid.obstacles, grid.empty) for c in part]
    assert len(cells) == len(set(cells))
    numbers = np.array(cells) / grid.cell_size - 0.5
    assert np.allclose(numbers, np.rint(numbers), atol=1e-3), "centres of cells"


def test_rays_free_what_lies_before_an_obstacle_and_nothing_behind() -> None:
    grid = make(tilted(pitch=0.0), table=False, wall=3.0)
    assert len(grid.empty) > 500
    assert grid.empty[:, 0].max() < 3.0
    off = make(tilted(pitch=0.0), PARAMS.changed({"Grid/RayTracing": False}), wall=3.0)
    assert len(off.empty) == 0
    assert np.array_equal(off.ground, grid.ground)


def test_range_and_height_limits() -> None:
    near = make(params=PARAMS.changed({"Grid/RangeMax": 2.0}))
    assert len(near.obstacles) == 0
    assert 0 < near.ground[:, 0].max() <= 2.3
    low = make(table=True, params=PARAMS.changed({"Grid/MaxObstacleHeight": -0.5}))
    assert not among(low.obstacles, *TABLE[:2]).any()
    under = make(params=PARAMS.changed({"Grid/MaxGroundHeight": -HEIGHT - 0.2}))
    assert len(under.ground) == 0
    assert len(under.obstacles) > 1000


def test_slopes_steeper_than_the_angle_are_obstacles() -> None:
    # Telling the grid that the camera looks straight ahead makes of the floor a slope of 0.35 rad, 20 degrees.
    depth = render(DOWN)
    ramp = make_local_grid(depth, CAMERA, tilted(), PARAMS)
    steep = make_local_grid(depth, CAMERA, tilted(), PARAMS.changed({"Grid/MaxGroundAngle": 10.0}))
    assert len(ramp.ground) > 1000
    assert len(steep.ground) == 0


def test_no_depth_says_nothing() -> None:
    grid = make_local_grid(np.zeros((480, 640), np.float32), CAMERA, level(DOWN), PARAMS)
    assert len(grid.ground) == len(grid.obstacles) == len(grid.empty) == 0


def test_specks_are_noise() -> None:
    depth = render(DOWN)
    depth[96:104, 96:104] = 0.5
    assert np.all(np.abs(make_local_grid(depth, CAMERA, level(DOWN), PARAMS).obstacles[:, 0] - 4.0) < 0.06)


def test_the_same_image_gives_the_same_bits() -> None:
    a, b = make(table=True), make(table=True)
    assert np.array_equal(a.ground, b.ground)
    assert np.array_equal(a.obstacles, b.obstacles)
    assert np.array_equal(a.empty, b.empty)


@given(roll=st.floats(-3, 3), pitch=st.floats(-1.3, 1.3), heading=st.floats(-3, 3))
def test_level_keeps_roll_and_pitch_and_takes_the_yaw_away(roll: float, pitch: float, heading: float) -> None:
    T = tilted(roll, pitch, heading)
    assert np.allclose(to_euler_rpy(level(T)), [*to_euler_rpy(T)[:2], 0.0], atol=1e-9)
    assert np.allclose(tilted(yaw=yaw(T)) @ level(T), T, atol=1e-12)


def test_level_is_defined_for_a_camera_that_looks_straight_down() -> None:
    T = tilted(pitch=np.pi / 2)
    assert np.allclose(level(T)[:3, 0], [0, 0, -1], atol=1e-9)
    assert abs(yaw(T)) < 1e-9


def test_a_small_camera_is_a_camera() -> None:
    small = Camera(64, 48, 52.5, 52.5, 31.5, 23.5)
    depth = render(DOWN)[::10, ::10]
    grid = make_local_grid(depth, small, level(DOWN), PARAMS.changed({"Grid/DepthDecimation": 1}))
    assert len(grid.ground) > 200
