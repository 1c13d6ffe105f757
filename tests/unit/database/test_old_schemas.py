"""A file of every schema is read as what it means, and no byte of it is changed."""

from __future__ import annotations

import hashlib
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.database.calibration import is_stereo
from slam.errors import DatabaseError
from slam.geometry import rotation_angle, so3_exp
from slam.types import LinkType
from tests.unit.database import old_files as old
from tests.unit.database.test_reader import CALLS

VERSIONS = (
    (0, 6, 0),
    (0, 7, 0),
    (0, 7, 4),
    (0, 8, 0),
    (0, 8, 4),
    (0, 8, 11),
    (0, 10, 0),
    (0, 10, 1),
    (0, 10, 7),
    (0, 11, 1),
    (0, 11, 5),
    (0, 11, 13),
    (0, 12, 0),
    (0, 13, 0),
    (0, 14, 0),
    (0, 15, 0),
    (0, 16, 1),
    (0, 17, 6),
    (0, 18, 0),
    (0, 19, 3),
    (0, 20, 0),
    (0, 22, 0),
    (0, 23, 0),
)


@pytest.fixture(scope="module", params=VERSIONS, ids=lambda version: ".".join(map(str, version)))
def version(request: pytest.FixtureRequest) -> old.Version:
    """One that changed something."""
    found: old.Version = request.param
    return found


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory, version: old.Version) -> MapReader:
    """Of a file of this version."""
    return MapReader(old.write_old(tmp_path_factory.mktemp("old") / "old.db", version))


def test_nodes_have_what_the_version_stored(reader: MapReader, version: old.Version) -> None:
    table = reader.nodes()
    dated = version >= (0, 8, 5)
    assert table.ids.tolist() == [1, 2, 3]
    assert table.weights.tolist() == [0, 0, 2]
    assert table.stamps.tolist() == ([101.0, 102.0, 103.0] if dated else [0.0, 0.0, 0.0])
    assert table.labels[0] == ("start" if dated else None)
    np.testing.assert_allclose(table.T_odom[:, :3], [old.pose(i) for i in (1, 2, 3)], atol=1e-7)
    assert np.isnan(table.T_world).all()
    node = reader.node(1)
    assert (node.features, node.words, node.has_grid) == (2, 2, version >= (0, 11, 10))
    assert node.image_bytes == len(old.png(old.IMAGE))


def test_images_and_camera(reader: MapReader, version: old.Version) -> None:
    assert reader.nodes_with("image").tolist() == reader.nodes_with("calibration").tolist() == [1, 2]
    np.testing.assert_array_equal(reader.image_bgr(1), old.IMAGE)
    np.testing.assert_allclose(reader.depth_m(1), old.DEPTH_MM / 1000, atol=1e-6)
    camera = reader.camera(1)
    assert (camera.width, camera.height) == (64, 48)
    fy = old.FY if version >= (0, 7, 0) else old.FX
    np.testing.assert_allclose([camera.fx, camera.fy, camera.cx, camera.cy], [old.FX, fy, old.CX, old.CY], rtol=1e-6)
    np.testing.assert_allclose(camera.T_base_cam[:3], old.LOCAL)
    np.testing.assert_array_equal(reader.first_cameras()[2].K, camera.K)


def test_links_have_types_and_information(reader: MapReader, version: old.Version) -> None:
    links = reader.links()
    assert [(link.from_id, link.to_id) for link in links] == [(2, 1), (3, 1), (3, 2)]
    assert [link.type for link in links] == [LinkType.NEIGHBOR, LinkType.GLOBAL_CLOSURE, LinkType.NEIGHBOR]
    assert [link.T_from_to[0, 3] for link in links if link.T_from_to is not None] == [-0.5, -1.0, -0.5]
    translation, rotation = old.TRANSLATION, old.ROTATION
    if version < (0, 8, 4):
        translation = rotation if version >= (0, 7, 4) else 1.0
        rotation = translation
    np.testing.assert_allclose(links[0].information, np.diag([1 / translation] * 3 + [1 / rotation] * 3))


def test_key_points_and_words(reader: MapReader, version: old.Version) -> None:
    features, words = reader.features(1)
    assert words.tolist() == [1, 2]
    assert features.pixels.tolist() == [[1.5, 2.5], [1.5, 2.5]]
    assert features.octaves.tolist() == ([1, 1] if version >= (0, 12, 0) else [0, 0])
    assert features.points_base.tolist() == [[1.0, 2.0, 3.0]] * 2
    assert features.descriptors.shape == ((2, 32) if version >= (0, 11, 2) else (2, 0))
    dictionary = reader.words()
    assert dictionary.ids.tolist() == [1, 2]
    assert dictionary.descriptors[:, 0].tolist() == [1, 2]


def test_scans_are_where_the_scanner_was(reader: MapReader, version: old.Version) -> None:
    scan = reader.scan(1)
    assert scan is not None
    np.testing.assert_array_equal(scan.points_base[:, :2], old.SCAN)
    np.testing.assert_allclose(scan.points_base[:, 2], 0.125 if version >= (0, 11, 10) else 0.0)


def test_what_the_sessions_left(reader: MapReader, version: old.Version) -> None:
    statistics = reader.statistics()
    if version >= (0, 11, 11):
        assert statistics.ids.tolist() == [3]
        assert {name: float(column[0]) for name, column in statistics.values.items()} == {
            "Loop/Id/": 1.0,
            "Timing/Total/ms": 12.5,
        }
    else:
        assert not len(statistics.ids)
    states = {node_id: state.tolist() for node_id, state in reader.wm_states().items()}
    assert states == ({3: [1, 2]} if version >= (0, 16, 2) else {})
    named = {"Kp/MaxFeatures": "400", "Rtabmap/LoopThr": "0.15"}
    assert reader.parameters() == (named if version >= (0, 11, 8) else {})
    nodes, words = reader.memory_ids()
    assert (nodes.tolist(), words.tolist()) == ([1, 2, 3], [1, 2])
    info = reader.info()
    assert (info.version, info.sessions, info.nodes, info.words) == (".".join(map(str, version)), 1, 3, 2)
    assert info.links == {"Neighbor": 2, "GlobalClosure": 1}
    assert info.clean


def test_grids_and_optimised_poses(reader: MapReader, version: old.Version) -> None:
    local = reader.local_grid(1)
    if version >= (0, 11, 10):
        assert local is not None
        np.testing.assert_array_equal(local.ground, old.CELLS[0, :, :2])
        np.testing.assert_array_equal(local.obstacles, old.CELLS[0, :, :2])
        assert len(local.empty) == (2 if version >= (0, 16, 0) else 0)
    else:
        assert local is None
    grid, poses = reader.grid(), reader.poses()
    if version >= (0, 17, 0):
        assert grid is not None
        assert grid.cells.tolist() == [[-1, 0], [100, 0]]
        assert sorted(poses) == [1, 2, 3]
    else:
        assert grid is None
        assert poses == {}


def test_reading_changes_no_byte(reader: MapReader) -> None:
    path = reader.path
    path.chmod(0o444)
    before = hashlib.sha256(path.read_bytes()).hexdigest()
    again = MapReader(path)
    for call in CALLS:
        call(again)
    assert hashlib.sha256(path.read_bytes()).hexdigest() == before
    assert [item.name for item in path.parent.iterdir()] == [path.name]


@pytest.mark.parametrize("version", [(0, 11, 1), (0, 11, 2), (0, 17, 6)])
def test_stereo_and_several_cameras(tmp_path: Path, version: old.Version) -> None:
    two = old.calibration_of(version, cameras=2)
    cameras = MapReader(old.write_old(tmp_path / "two.db", version, calibration=two)).cameras(1)
    assert [(camera.width, camera.height, camera.fx) for camera in cameras] == [(32, 48, 52.5)] * 2
    stereo = old.calibration_of(version, stereo=True)
    reader = MapReader(old.write_old(tmp_path / "stereo.db", version, calibration=stereo))
    (camera,) = reader.cameras(1)
    assert (camera.width, camera.fx, camera.fy) == (64, old.FX, old.FY)


def test_a_focal_length_below_one_is_a_baseline(tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "stereo.db", (0, 8, 5))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Depth SET fy = 0.125")
        connection.commit()
    (camera,) = MapReader(path).cameras(1)
    assert (camera.fx, camera.fy) == (old.FX, old.FX)


def test_rotations_that_are_a_little_off_are_set_right(tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "skewed.db", (0, 11, 13))
    R = so3_exp(np.array([0.1, 0.2, 0.3]))
    skewed = np.column_stack([1.001 * R, [1.0, 2.0, 3.0]]).astype("<f4").tobytes()
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Node SET pose = ?", (skewed,))
        connection.commit()
    T = MapReader(path).nodes().T_odom[0]
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-6)
    assert rotation_angle(T) == pytest.approx(np.linalg.norm([0.1, 0.2, 0.3]), abs=1e-4)
    assert T[:3, 3].tolist() == [1.0, 2.0, 3.0]


def test_links_of_the_oldest_files_close_loops_whatever_their_number(tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 7, 0))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Link SET type = 2 WHERE type = 1")
        connection.commit()
    assert MapReader(path).info().links == {"Neighbor": 2, "GlobalClosure": 1}


@pytest.mark.parametrize("table", ["Node", "Link", "Word"])
def test_a_table_that_is_missing_is_named(tmp_path: Path, table: str) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 11, 13))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute(f"DROP TABLE {table}")
        connection.commit()
    with pytest.raises(DatabaseError, match=f"no table {table}"):
        MapReader(path)


@pytest.mark.parametrize(
    ("call", "statement", "says"),
    [
        (lambda reader: reader.camera(1), "UPDATE Data SET calibration = x'0102030405'", "no camera"),
        (lambda reader: reader.scan(1), "UPDATE Data SET scan_info = x'01020304'", "scan_info has 1 numbers"),
    ],
)
def test_what_can_not_be_converted_is_refused_by_name(tmp_path: Path, call: object, statement: str, says: str) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 16, 1))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute(statement)
        connection.commit()
    assert callable(call)
    with pytest.raises(DatabaseError, match=says):
        call(MapReader(path))


def test_an_old_file_is_not_written(tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 17, 6))
    before = path.read_bytes()
    with pytest.raises(DatabaseError, match=r"files before 0\.18 can be read, but not changed"):
        MapWriter.open(path)
    assert path.read_bytes() == before


def test_stereo_stays_stereo(tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 11, 13), calibration=old.calibration_of((0, 11, 13), stereo=True))
    reader = MapReader(path)
    with reader._reading("looking") as connection:
        blob = connection.exec_driver_sql("SELECT calibration FROM Data").scalars().first()
    assert isinstance(blob, bytes)
    assert is_stereo(blob)
