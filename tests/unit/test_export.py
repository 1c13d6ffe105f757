"""Trajectories in other tools' formats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.camera import T_BASE_OPTICAL
from slam.errors import DatabaseError
from slam.export import write_kitti, write_tum
from slam.geometry import from_quat_xyzw
from tests.graphs import truth

POSES = truth(12)
STAMPS = [1305031102.175304 + 0.5 * i for i in range(12)]


def test_tum_lines_are_stamp_position_and_quaternion(tmp_path: Path) -> None:
    write_tum(tmp_path / "a.txt", STAMPS, POSES)
    rows = np.loadtxt(tmp_path / "a.txt")
    assert np.allclose(rows[:, 0], STAMPS, atol=1e-6)
    back = [from_quat_xyzw(row[4:], row[1:4]) for row in rows]
    assert np.allclose(back, POSES, atol=1e-8)


def test_the_optical_frame_on_demand(tmp_path: Path) -> None:
    write_tum(tmp_path / "a.txt", STAMPS, POSES, T_BASE_OPTICAL)
    for row, T_map_base in zip(np.loadtxt(tmp_path / "a.txt"), POSES, strict=True):
        assert np.allclose(from_quat_xyzw(row[4:], row[1:4]), T_map_base @ T_BASE_OPTICAL, atol=1e-8)


def test_kitti_lines_are_matrices(tmp_path: Path) -> None:
    write_kitti(tmp_path / "a.txt", POSES)
    assert np.allclose(np.loadtxt(tmp_path / "a.txt").reshape(-1, 3, 4), np.array(POSES)[:, :3], atol=1e-8)


def test_what_can_not_be_written_is_refused_and_leaves_the_old_file(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(DatabaseError, match="11 stamps for 12 poses"):
        write_tum(tmp_path / "a.txt", STAMPS[1:], POSES)
    with pytest.raises(DatabaseError, match="can't be written"):
        write_kitti(tmp_path / "nowhere" / "a.txt", POSES)
    assert (tmp_path / "a.txt").read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["a.txt"]
    (tmp_path / "folder").mkdir()
    with pytest.raises(DatabaseError, match="folder: can't be written"):
        write_kitti(tmp_path / "folder", POSES)
    (tmp_path / "folder").rmdir()
    assert [file.name for file in tmp_path.iterdir()] == ["a.txt"]
