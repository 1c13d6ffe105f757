"""The grid of a running map: what is put off while it runs is done when all poses are followed at once."""

from __future__ import annotations

import numpy as np

from slam.geometry import Pose, make
from slam.maps.grid_layer import GridLayer
from slam.params import Params
from slam.types import OccupancyGrid
from tests.tours import sparse

PARAMS = Params()


def at(x: float, y: float) -> Pose:
    return make(np.eye(3), np.array([x, y, 0.4]))


def laid(poses: dict[int, Pose]) -> GridLayer:
    layer = GridLayer(PARAMS)
    for node_id, frame in zip(poses, sparse(), strict=False):
        layer.add(node_id, frame, poses, PARAMS)
    return layer


def cells(layer: GridLayer) -> OccupancyGrid:
    grid = layer.occupancy()
    assert grid is not None
    return grid


def test_poses_noted_earlier_are_followed_at_the_end() -> None:
    before, after = {1: at(0, 0), 2: at(1, 0)}, {1: at(0, 0), 2: at(1, 2)}
    layer = laid(before)
    layer._touches = 0  # the grid is not made anew in this update
    layer.follow(after, [1, 2])
    stale = cells(layer)
    layer.move(after)
    assert stale.cells.shape != cells(layer).cells.shape
    np.testing.assert_array_equal(cells(layer).cells, cells(laid(after)).cells)


def test_a_node_that_is_left_out_leaves_no_cells() -> None:
    poses = {1: at(0, 0), 2: at(1, 3)}
    layer = laid(poses)
    layer.leave_out(2)
    del poses[2]
    layer.move(poses)
    np.testing.assert_array_equal(cells(layer).cells, cells(laid(poses)).cells)
