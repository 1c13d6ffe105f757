"""The path of all frames follows the nodes it hangs on."""

from __future__ import annotations

import numpy as np

from slam.trajectory import assemble
from slam.types import TrackedFrame
from tests.nodes import at


def frame(index: int, node_id: int, ahead: float | None, *, known: bool = True) -> TrackedFrame:
    T_node_base = None if ahead is None else at(ahead)
    return TrackedFrame(index, 0.1 * index, node_id, T_node_base, at(float(index)) if known else None, 50, 1.0)


def test_frames_hang_on_their_nodes() -> None:
    frames = [frame(0, 1, 0.0), frame(1, 1, 0.5), frame(2, 2, 0.0), frame(3, 2, 0.25)]
    path = assemble(frames, {1: at(0.0), 2: at(1.0, 0.0, 90.0)})
    np.testing.assert_allclose(path.T_map_base[:, :2, 3], np.array([[0, 0], [0.5, 0], [1, 0], [1, 0.25]]), atol=1e-12)
    moved = assemble(frames, {1: at(0.0), 2: at(2.0)})
    np.testing.assert_allclose(moved.T_map_base[:, :2, 3], np.array([[0, 0], [0.5, 0], [2, 0], [2.25, 0]]), atol=1e-12)
    assert path.stamps.tolist() == [0.0, 0.1, 0.2, 0.1 * 3]


def test_lost_frames_and_those_before_the_map_are_left_out() -> None:
    path = assemble([frame(0, 0, 0.0), frame(1, 1, 0.0), frame(2, 1, None), frame(3, 9, 0.0)], {1: at(0.0)})
    assert path.stamps.tolist() == [0.1]


def test_unknown_truth_is_not_a_number() -> None:
    path = assemble([frame(0, 1, 0.0), frame(1, 1, 0.1, known=False)], {1: at(0.0)})
    assert np.isnan(path.T_world_base[1]).all()
    np.testing.assert_array_equal(path.T_world_base[0], at(0.0))


def test_nothing_makes_an_empty_path() -> None:
    path = assemble([], {})
    assert path.T_map_base.shape == path.T_world_base.shape == (0, 4, 4)
    assert path.stamps.shape == (0,)
