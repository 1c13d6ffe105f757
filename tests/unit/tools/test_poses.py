"""Poses of maps in the formats of RTAB-Map's tools."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.camera import T_BASE_OPTICAL
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import from_quat_xyzw, inverse
from slam.graph.g2o import read_g2o
from slam.tools.poses import Every, Format, Which, Whose, export_poses
from tests.tours import saved


@pytest.fixture(scope="module")
def reader() -> MapReader:
    return MapReader(saved(0))


def written(reader: MapReader, folder: Path, format: Format, **options: object) -> np.ndarray:
    export_poses(reader, folder / "out.txt", format, **options)  # type: ignore[arg-type]
    return np.loadtxt(folder / "out.txt")


def test_ids_stand_behind_the_nodes_of_tum_lines(reader: MapReader, tmp_path: Path) -> None:
    rows = written(reader, tmp_path, Format.TUM_ID, whose=Whose.BASE)
    assert rows[:, 8].tolist() == reader.nodes().ids.tolist()
    for row in rows:
        np.testing.assert_allclose(from_quat_xyzw(row[4:8], row[1:4]), reader.poses()[int(row[8])], atol=1e-6)


@pytest.mark.parametrize(("which", "column"), [(Which.ODOMETRY, "T_odom"), (Which.TRUTH, "T_world")])
def test_odometry_and_truth_instead_of_the_optimised_poses(
    reader: MapReader, tmp_path: Path, which: Which, column: str
) -> None:
    rows = written(reader, tmp_path, Format.RAW, which=which, every=Every.NODE, whose=Whose.BASE)
    np.testing.assert_allclose(rows.reshape(-1, 3, 4), getattr(reader.nodes(), column)[:, :3], atol=1e-6)


def test_kitti_has_optical_axes_in_the_world_and_raw_those_of_the_map(reader: MapReader, tmp_path: Path) -> None:
    kitti = written(reader, tmp_path, Format.KITTI).reshape(-1, 3, 4)
    raw = written(reader, tmp_path, Format.RAW).reshape(-1, 3, 4)
    np.testing.assert_allclose(kitti, inverse(T_BASE_OPTICAL)[:3, :3] @ raw, atol=1e-8)


def test_toro_and_g2o_hold_the_same_graph(reader: MapReader, tmp_path: Path) -> None:
    export_poses(reader, tmp_path / "a.g2o", Format.G2O)
    graph = read_g2o(tmp_path / "a.g2o")
    export_poses(reader, tmp_path / "a.graph", Format.TORO)
    lines = [line.split() for line in (tmp_path / "a.graph").read_text().splitlines()]
    vertices = {int(line[1]): np.array(line[2:], float) for line in lines if line[0] == "VERTEX3"}
    edges = {(int(line[1]), int(line[2])): np.array(line[3:], float) for line in lines if line[0] == "EDGE3"}
    assert vertices.keys() == graph.poses.keys() and edges.keys() == graph.links.keys()
    for pair, numbers in edges.items():
        np.testing.assert_allclose(numbers[6:], graph.links[pair].information[np.triu_indices(6)])
        T = graph.links[pair].T_from_to
        assert T is not None
        np.testing.assert_allclose(numbers[:3], T[:3, 3], atol=1e-9)
        c, s = np.cos(numbers[3:6]), np.sin(numbers[3:6])
        turn = np.array([[c[2], -s[2], 0], [s[2], c[2], 0], [0, 0, 1]]) @ np.array(
            [[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]]
        )
        np.testing.assert_allclose(
            turn @ np.array([[1, 0, 0], [0, c[0], -s[0]], [0, s[0], c[0]]]), T[:3, :3], atol=1e-9
        )


def test_motion_capture_axes_are_those_of_rtabmaps_own_export(shared_data: Path, tmp_path: Path) -> None:
    folder = shared_data / "rtabmap_db"
    for name in ("cpp_0.23.8_toyroom", "cpp_0.23.8_tum_fr1_xyz_excerpt"):
        ours = written(MapReader(folder / f"{name}.db"), tmp_path, Format.RGBD_SLAM)
        theirs = np.loadtxt(folder / f"{name}_poses.txt")
        np.testing.assert_allclose(ours[:, :4], theirs[:, :4], atol=2e-6)
        np.testing.assert_allclose(np.abs((ours[:, 4:] * theirs[:, 4:]).sum(axis=1)), 1.0, atol=1e-5)


def test_what_the_map_does_not_know_is_refused(tmp_path: Path, shared_data: Path) -> None:
    path = next((shared_data / "rtabmap_db").glob("Strroke21*.db"))
    with pytest.raises(DatabaseError, match="no node has a true pose"):
        export_poses(MapReader(path), tmp_path / "out.txt", Format.TUM, which=Which.TRUTH)
