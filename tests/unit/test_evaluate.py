"""Trajectory errors against numbers worked out by hand, and against the peers' figures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.evaluate import absolute_error, associated
from slam.geometry import from_quat_xyzw, make


def line(*ys: float) -> np.ndarray:
    return np.array([make(np.eye(3), np.array([float(x), y, 0.0])) for x, y in enumerate(ys)])


def test_a_bump_on_a_line() -> None:
    # The best line through 0, h, 0 lies h / 3 higher: errors h/3, 2h/3, h/3.
    found = absolute_error(line(0, 0, 0), line(0, 0.3, 0))
    assert found.rmse_m == pytest.approx(np.sqrt(0.06 / 3), rel=1e-2)
    assert found.max_m == pytest.approx(0.2, rel=1e-2)
    assert found.median_m == pytest.approx(0.1, rel=1e-2)
    assert found.pairs == 3


def test_lists_of_poses_are_taken_too() -> None:
    assert absolute_error(list(line(0, 0, 1)), list(line(0, 0, 1))).rmse_m == pytest.approx(0.0, abs=1e-12)


def test_one_pose_fits_any_other() -> None:
    assert absolute_error(line(0), line(5)).rmse_m == 0.0


def test_rtabmaps_own_poses_have_the_error_it_printed(shared_data: Path) -> None:
    """RTAB-Map wrote key frame poses of toyroom beside its map; its error there is a few centimetres."""
    truth = np.loadtxt(shared_data / "toyroom" / "groundtruth.txt")
    poses = np.loadtxt(shared_data / "rtabmap_db" / "cpp_0.23.8_toyroom_poses.txt")
    T_world_cam = np.array([from_quat_xyzw(row[4:8], row[1:4]) for row in truth])
    T_map_base = np.array([from_quat_xyzw(row[4:8], row[1:4]) for row in poses])
    true, found = associated(truth[:, 0], T_world_cam, poses[:, 0], T_map_base)
    assert len(true) == len(poses)
    assert 0.005 < absolute_error(true, found).rmse_m < 0.05
