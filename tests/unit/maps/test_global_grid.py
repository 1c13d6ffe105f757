"""Laws of the global grid."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Pose, make, se3_exp, so3_exp
from slam.maps.global_grid import GlobalGrid
from slam.params import Params
from slam.types import LocalGrid, OccupancyGrid

PARAMS = Params()
SIZE = PARAMS.Grid.CellSize
NONE = np.zeros((0, 2), dtype=np.float32)
slowly = settings(max_examples=25, deadline=None)


def cells(*columns_rows: tuple[int, int]) -> NDArray[np.float32]:
    return ((np.array(columns_rows, dtype=np.float64).reshape(-1, 2) + 0.5) * SIZE).astype(np.float32)


def at(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Pose:
    return make(so3_exp(np.array([0.0, 0.0, yaw])), np.array([x, y, 0.3]))


def local(seed: int, n: int = 60) -> LocalGrid:
    rng = np.random.default_rng(seed)
    spots = rng.permutation(400)[: 3 * n]
    parts = [cells(*zip(s % 20, s // 20 - 10, strict=True)) for s in np.split(spots, 3)]
    return LocalGrid(parts[0], parts[1], parts[2], SIZE)


def same(a: OccupancyGrid | None, b: OccupancyGrid | None) -> bool:
    if a is None or b is None:
        return a is b
    return (a.x_min, a.y_min) == (b.x_min, b.y_min) and np.array_equal(a.cells, b.cells)


def poses(seed: int, nodes: int = 8, spread: float = 3.0) -> dict[int, Pose]:
    rng = np.random.default_rng(seed)
    return {i: at(*rng.uniform(-spread, spread, 2), rng.uniform(-3, 3)) for i in range(1, nodes + 1)}


def built(where: dict[int, Pose], order: list[int] | None = None) -> GlobalGrid:
    grid = GlobalGrid(PARAMS)
    for i in order or sorted(where):
        grid.add(i, local(i), where[i])
    return grid


def value(grid: GlobalGrid, column: int, row: int) -> int:
    found = grid.occupancy()
    assert found is not None
    k, i = column - round(found.x_min / SIZE), row - round(found.y_min / SIZE)
    inside = 0 <= i < found.cells.shape[0] and 0 <= k < found.cells.shape[1]
    return int(found.cells[i, k]) if inside else -1


def test_nothing_known_is_no_grid() -> None:
    grid = GlobalGrid(PARAMS)
    assert grid.occupancy() is None
    grid.add(1, LocalGrid(NONE, NONE, NONE, SIZE), at())
    assert grid.occupancy() is None


def test_cells_lie_where_the_pose_puts_them() -> None:
    grid = GlobalGrid(PARAMS)
    grid.add(
        1, LocalGrid(cells((1, 0)), cells((2, 0)), cells((3, 0)), SIZE), at(x=10 * SIZE, y=-4 * SIZE, yaw=np.pi / 2)
    )
    found = grid.occupancy()
    assert found is not None
    assert np.array_equal(found.cells, [[0], [100], [0]])
    assert np.isclose(found.x_min, 9 * SIZE)
    assert np.isclose(found.y_min, -3 * SIZE)
    assert value(grid, 9, -2) == 100


def test_a_node_changes_a_cell_once_and_its_obstacles_win() -> None:
    twice = LocalGrid(cells((1, 0), (1, 0)), cells((1, 0), (5, 0), (5, 0)), NONE, SIZE)
    grid = GlobalGrid(PARAMS)
    grid.add(1, twice, at())
    assert value(grid, 1, 0) == 100
    free = LocalGrid(cells((5, 0)), NONE, NONE, SIZE)
    for node_id in (2, 3):
        grid.add(node_id, free, at())
        assert value(grid, 5, 0) == 100, "0.847 - 2 x 0.405 > 0: hit once"
    grid.add(4, free, at())
    assert value(grid, 5, 0) == 0


def test_an_older_node_does_not_overwrite_a_newer_one() -> None:
    grid = GlobalGrid(PARAMS)
    grid.add(5, LocalGrid(cells((0, 0)), NONE, NONE, SIZE), at())
    grid.add(3, LocalGrid(NONE, cells((0, 0), (1, 0)), NONE, SIZE), at())
    assert value(grid, 0, 0) == 0
    assert value(grid, 1, 0) == 100


def test_cells_are_bounded_by_the_clamps() -> None:
    grid = GlobalGrid(PARAMS)
    wall = LocalGrid(NONE, cells((0, 0)), NONE, SIZE)
    for i in range(1, 101):
        grid.add(i, wall, at())
    assert value(grid, 0, 0) == 100
    steps = 0
    while value(grid, 0, 0) == 100:
        steps += 1
        grid.add(100 + steps, LocalGrid(cells((0, 0)), NONE, NONE, SIZE), at())
    assert steps == int(np.ceil(np.log(0.971 / 0.029) / -np.log(0.4 / 0.6)))


def test_single_gaps_between_free_cells_are_free_and_nothing_else_is() -> None:
    around = [(k % 3, k // 3) for k in range(9) if k != 4]
    grid = GlobalGrid(PARAMS)
    grid.add(1, LocalGrid(cells(*around), NONE, NONE, SIZE), at())
    assert value(grid, 1, 1) == 0
    beside_wall = GlobalGrid(PARAMS)
    beside_wall.add(1, LocalGrid(cells(*around[:4], *around[5:]), cells(around[4]), NONE, SIZE), at())
    assert value(beside_wall, 1, 1) == -1
    wide = GlobalGrid(PARAMS)
    wide.add(1, LocalGrid(cells((0, 0), (1, 0), (2, 0), (0, 2), (1, 2), (2, 2)), NONE, NONE, SIZE), at())
    assert value(wide, 1, 1) == -1


def test_turned_grids_have_no_holes() -> None:
    floor = cells(*((k % 60, k // 60 - 30) for k in range(3600)))
    grid = GlobalGrid(PARAMS)
    grid.add(1, LocalGrid(floor, NONE, NONE, SIZE), at(yaw=0.6))
    assert all(value(grid, k, 2 * k // 3) == 0 for k in range(3, 35))


@slowly
@given(seed=st.integers(0, 999), order=st.permutations(range(1, 9)))
def test_the_order_of_nodes_does_not_matter_where_no_cell_conflicts(seed: int, order: list[int]) -> None:
    where = {i: at(x=2.0 * i, y=-1.0 * i, yaw=0.3 * (seed % 7)) for i in range(1, 9)}
    assert same(built(where).occupancy(), built(where, list(order)).occupancy())


@slowly
@given(before=st.integers(0, 999), after=st.integers(0, 999))
def test_moved_nodes_give_what_building_from_scratch_gives(before: int, after: int) -> None:
    grid = built(poses(before))
    assert grid.move(poses(after)) == (before != after)
    assert same(grid.occupancy(), built(poses(after)).occupancy())


@slowly
@given(seed=st.integers(0, 999))
def test_adding_one_by_one_is_the_same_as_a_rebuild(seed: int) -> None:
    where = poses(seed, spread=20.0)
    grid = built({**where, 8: at()})
    grid.move(where)
    assert same(grid.occupancy(), built(where).occupancy())


@slowly
@given(seed=st.integers(0, 999), order=st.permutations(range(1, 9)))
def test_a_rebuild_goes_by_ids_whatever_the_order_of_adding(seed: int, order: list[int]) -> None:
    where = poses(seed, spread=0.3)
    grid = built({**where, 8: at(x=9.0)}, list(order))
    assert grid.move(where)
    assert same(grid.occupancy(), built(where).occupancy())


def test_small_moves_are_left_alone_and_turns_count_by_what_they_move() -> None:
    where = poses(1)
    grid, before = built(where), built(where).occupancy()
    assert not grid.move({i: T @ se3_exp(np.array([0.005, 0, 0, 0, 0, 0])) for i, T in where.items()})
    assert same(grid.occupancy(), before)
    assert grid.move({**where, 3: where[3] @ at(yaw=0.05)})


def test_nodes_that_leave_take_their_cells_along() -> None:
    where = poses(2)
    grid = built(where)
    del where[4]
    assert grid.move(where)
    assert len(grid) == 7
    assert same(grid.occupancy(), built(where).occupancy())


def test_a_node_that_is_added_again_is_replaced() -> None:
    where = poses(3)
    grid = built(where)
    grid.add(2, local(99), where[2])
    other = GlobalGrid(PARAMS)
    for i in where:
        other.add(i, local(99 if i == 2 else i), where[i])
    assert same(grid.occupancy(), other.occupancy())


def test_the_threshold_works_live() -> None:
    grid = GlobalGrid(PARAMS)
    grid.add(1, LocalGrid(NONE, cells((0, 0)), NONE, SIZE), at())
    assert value(grid, 0, 0) == 100
    grid.params = PARAMS.changed({"GridGlobal/OccupancyThr": 0.8})
    assert value(grid, 0, 0) == 0


@slowly
@given(st.integers(0, 1000), st.integers(1, 8))
def test_probabilities_tell_what_is_occupied(seed: int, nodes: int) -> None:
    grid = built(poses(seed, nodes))
    plan, likely = grid.occupancy(), grid.probability()
    assert plan is not None and likely is not None
    assert (plan.x_min, plan.y_min, plan.cells.shape) == (likely.x_min, likely.y_min, likely.cells.shape)
    known = likely.cells >= 0
    assert np.array_equal(likely.cells[known] >= 50, plan.cells[known] == 100)
    # Gaps between free cells are filled in the plan alone.
    assert (plan.cells[~known] <= 0).all() and likely.cells.max() <= 100
