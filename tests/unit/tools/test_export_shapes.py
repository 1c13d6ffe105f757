"""Floor plan and cloud of a map as files."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import make
from slam.graph.graph import PoseGraph
from slam.maps.global_grid import GlobalGrid
from slam.tools.cloud import export_cloud
from slam.tools.floor_plan import export_floor_plan, floor_plan
from tests.tours import saved


class WithoutGrid(MapReader):
    """A map whose global grid was never stored."""

    def grid(self) -> None:
        """There is none."""


@pytest.fixture
def reader() -> MapReader:
    """A stretch of the rendered tour."""
    return MapReader(saved(0, 6))


def test_the_floor_plan_is_the_stored_grid(reader: MapReader, tmp_path: Path) -> None:
    stored = reader.grid()
    assert stored is not None
    assert export_floor_plan(reader, tmp_path / "flat.pgm", {}) is not None
    image = cv2.imread(str(tmp_path / "flat.pgm"), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(image[::-1] == 0, stored.cells >= 50)
    said = yaml.safe_load((tmp_path / "flat.yaml").read_text())
    assert said["image"] == "flat.pgm" and said["resolution"] == stored.cell_size


def test_without_a_stored_grid_it_is_made_of_the_local_ones_where_nodes_are() -> None:
    reader = WithoutGrid(saved(0, 6))
    poses = PoseGraph.from_reader(reader).poses
    made = floor_plan(reader, poses)
    stored = MapReader(saved(0, 6)).grid()
    assert stored is not None and made.cells.shape == stored.cells.shape
    assert np.array_equal(made.cells, stored.cells)
    moved = floor_plan(reader, {i: make(np.eye(3), np.array([5.0, 0.0, 0.0])) @ T for i, T in poses.items()})
    assert moved.x_min == pytest.approx(made.x_min + 5.0, abs=made.cell_size)


def test_a_floor_plan_that_makes_no_sense_is_refused(
    reader: MapReader, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = PoseGraph.from_reader(reader).poses
    with pytest.raises(DatabaseError, match=r"plan\.png.*\.pgm"):
        export_floor_plan(reader, tmp_path / "plan.png", poses)
    bare = WithoutGrid(saved(0, 6))
    with pytest.raises(DatabaseError, match="no floor plan"):
        floor_plan(bare, {})
    monkeypatch.setattr(GlobalGrid, "add_all", lambda *_: pytest.fail("it would fill the memory"))
    far = {1: poses[1], 2: make(np.eye(3), np.array([1e6, 1e6, 0.0]))}
    with pytest.raises(DatabaseError, match=r"1000\d\d\d x 1000\d\d\d m"):
        floor_plan(bare, far)


def test_the_cloud_follows_the_poses_and_the_voxels(reader: MapReader, tmp_path: Path) -> None:
    poses = PoseGraph.from_reader(reader).poses
    fine = export_cloud(reader, tmp_path / "fine.ply", poses, 0.05)
    coarse = export_cloud(reader, tmp_path / "coarse.ply", poses, 0.2)
    assert fine > 3 * coarse > 0
    moved = {i: make(np.eye(3), np.array([0.0, 0.0, 40.0])) @ T for i, T in poses.items()}
    export_cloud(reader, tmp_path / "moved.ply", moved, 0.2)
    here, there = (_points(tmp_path / f"{name}.ply") for name in ("coarse", "moved"))
    assert np.allclose(there.mean(axis=0) - here.mean(axis=0), [0.0, 0.0, 40.0], atol=0.05)
    near = export_cloud(reader, tmp_path / "near.ply", poses, 0.2, range_m=1.5)
    assert near < coarse


def test_a_cloud_of_nothing_is_refused(reader: MapReader, tmp_path: Path) -> None:
    poses = PoseGraph.from_reader(reader).poses
    with pytest.raises(DatabaseError, match="no node with a pose"):
        export_cloud(reader, tmp_path / "a.ply", {})
    with pytest.raises(DatabaseError, match="voxels of 0 m"):
        export_cloud(reader, tmp_path / "a.ply", poses, 0.0)
    assert not list(tmp_path.iterdir())


def _points(path: Path) -> np.ndarray:
    body = path.read_bytes().split(b"end_header\n", 1)[1]
    return np.frombuffer(body, np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3)]))["xyz"]
