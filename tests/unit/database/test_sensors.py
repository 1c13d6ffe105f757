"""GPS, sensors, user data, descriptors, markers, stereo pairs, clouds and meshes are read as they were stored."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest

from slam.database import MapReader
from slam.database.sensor_values import text_in
from slam.errors import DatabaseError
from tests.unit.database import old_files as old
from tests.unit.database.old_files import Version, z


def changed(path: Path, *statements: tuple[str, tuple[object, ...]], version: Version = (0, 20, 0)) -> MapReader:
    """A file of a version after these statements."""
    old.write_old(path, version)
    with closing(sqlite3.connect(path)) as connection:
        for statement, values in statements:
            connection.execute(statement, values)
        connection.commit()
    return MapReader(path)


@pytest.mark.parametrize("version", [(0, 8, 8), (0, 10, 0), (0, 10, 1), (0, 13, 0), (0, 14, 0), (0, 18, 0), (0, 20, 0)])
def test_each_version_has_what_it_stored(tmp_path: Path, version: Version) -> None:
    reader = MapReader(old.write_old(tmp_path / "old.db", version))
    found = reader.sensors(1)
    assert text_in(found.user_data) == old.USER_DATA.decode()
    assert (found.velocity is not None) == (version >= (0, 13, 0))
    if found.velocity is not None:
        assert found.velocity.tolist() == [1, 2, 3, 4, 5, 6]
    gps = found.gps
    assert (gps is not None) == (version >= (0, 14, 0))
    if gps is not None:
        assert (gps.stamp, gps.longitude, gps.latitude, gps.altitude, gps.error, gps.bearing) == old.GPS
    assert reader.gps() == ({1: gps} if gps else {})
    readings = [(one.kind, one.value, one.stamp) for one in found.environment]
    assert readings == (list(old.SENSORS) if version >= (0, 18, 0) else [])
    vectors = [vector.values.tolist() for vector in found.descriptors]
    assert vectors == ([[0, 1, 2, 3]] if version >= (0, 20, 0) else [])
    other = reader.sensors(2)
    assert (other.gps, other.environment, other.user_data, other.descriptors) == (None, (), None, ())


def test_readings_have_names_and_units(tmp_path: Path) -> None:
    blob = b"".join(struct.pack("<3d", kind, 1.0, 2.0) for kind in (2, 1, 103))
    reader = changed(tmp_path / "map.db", ("UPDATE Node SET env_sensors = ? WHERE id = 1", (blob,)))
    named = [(one.name, one.unit) for one in reader.sensors(1).environment]
    assert named == [("temperature", "°C"), ("Wi-Fi signal", "dBm"), ("custom 103", "")]


def test_user_data_that_are_no_text_stay_numbers(tmp_path: Path) -> None:
    matrix = np.arange(6, dtype=np.float32).reshape(2, 3)
    reader = changed(tmp_path / "map.db", ("UPDATE Data SET user_data = ? WHERE id = 1", (z(matrix, 5),)))
    found = reader.sensors(1)
    assert text_in(found.user_data) is None
    np.testing.assert_array_equal(found.user_data, matrix)


@pytest.mark.parametrize(("column", "says"), [("gps", "48 bytes each"), ("env_sensors", "24 bytes each")])
def test_blobs_of_another_size_are_refused_with_the_node(tmp_path: Path, column: str, says: str) -> None:
    reader = changed(tmp_path / "map.db", (f"UPDATE Node SET {column} = ? WHERE id = 1", (b"x" * 23,)))
    with pytest.raises(DatabaseError, match=f"node 1 .*{says}"):
        reader.sensors(1)


def test_markers_have_the_length_of_their_side(tmp_path: Path) -> None:
    pose, information = old.pose(2).tobytes(), np.eye(6).tobytes()
    insert = "INSERT INTO Link VALUES (1, -7, 8, ?, ?, ?)"
    length = z(np.array([[0.25]], np.float32), 5)
    reader = changed(tmp_path / "map.db", (insert, (information, pose, length)))
    assert reader.marker_lengths() == {-7: 0.25}
    assert reader.links()[0].pair == (-7, 1)


def test_links_of_one_direction_are_counted(tmp_path: Path) -> None:
    assert MapReader(old.write_old(tmp_path / "whole.db", (0, 20, 0))).one_way_links() == 0
    reader = changed(tmp_path / "map.db", ("DELETE FROM Link WHERE from_id < to_id AND type = 0", ()))
    assert reader.one_way_links() == 2


@pytest.mark.parametrize("version", [(0, 8, 5), (0, 11, 1), (0, 11, 13)])
def test_a_stereo_pair_has_its_baseline_and_right_image(tmp_path: Path, version: Version) -> None:
    right = old.IMAGE[:, ::-1].copy()
    calibration = old.calibration_of(version, stereo=True)
    path = old.write_old(tmp_path / "stereo.db", version, calibration=calibration, depth=old.png(right))
    if version < (0, 10, 0):
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("UPDATE Depth SET fy = ?", (old.BASELINE,))
            connection.commit()
    reader = MapReader(path)
    assert reader.baselines(1) == pytest.approx((old.BASELINE,))
    np.testing.assert_array_equal(reader.right_bgr(1), right)
    with pytest.raises(DatabaseError, match="right image of a stereo pair is no depth"):
        reader.depth_m(1)


def test_float_depth_is_metres(tmp_path: Path) -> None:
    depth_m = np.linspace(0, 5, 64 * 48, dtype=np.float32).reshape(48, 64)
    reader = MapReader(
        old.write_old(tmp_path / "f.db", (0, 11, 13), depth=old.png(depth_m.view(np.uint8).reshape(48, 64, 4)))
    )
    np.testing.assert_array_equal(reader.depth_m(1), depth_m)
    assert reader.baselines(1) == ()


COLOURED = np.zeros((1, 2, 4), np.float32)
COLOURED[..., 3] = np.array([0x00AABBCC, 0x00102030], np.int32).view(np.float32)


@pytest.mark.parametrize("channels", range(2, 8))
def test_assembled_clouds_of_all_channels(tmp_path: Path, channels: int) -> None:
    rows = np.random.default_rng(4).normal(size=(1, 30, channels)).astype(np.float32)
    reader = changed(tmp_path / "map.db", ("UPDATE Admin SET opt_cloud = ?", (z(rows, 5 + 8 * (channels - 1)),)))
    cloud = reader.cloud()
    assert cloud is not None
    np.testing.assert_array_equal(cloud.points[:, :2], rows[0, :, :2])
    np.testing.assert_array_equal(cloud.points[:, 2], 0 if channels in (2, 5) else rows[0, :, 2])
    assert (cloud.colours is not None) == (channels in (4, 7))


def test_colours_are_red_first(tmp_path: Path) -> None:
    cloud = changed(tmp_path / "map.db", ("UPDATE Admin SET opt_cloud = ?", (z(COLOURED, 29),))).cloud()
    assert cloud is not None
    assert cloud.colours is not None
    assert cloud.colours.tolist() == [[0xAA, 0xBB, 0xCC], [0x10, 0x20, 0x30]]


def test_a_mesh_with_textures(tmp_path: Path) -> None:
    """Two materials: one quadrangle, and one more; each corner has its place in the texture."""
    polygons = np.array([[1, 0, 1, 2, 3, 1, 4, 5, 6, 7]], np.int32)
    square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]
    corners = np.array([[4, *square, 4, *square]], np.float32)
    texture = cv2.imencode(".jpg", np.zeros((8, 16, 3), np.uint8))[1].tobytes()
    statement = "UPDATE Admin SET opt_polygons_size = 4, opt_polygons = ?, opt_tex_coords = ?, opt_tex_materials = ?"
    reader = changed(tmp_path / "map.db", (statement, (z(polygons, 4), z(corners, 5), texture)))
    mesh = reader.mesh()
    assert mesh is not None
    assert mesh.textures == texture
    assert [part.triangles.tolist() for part in mesh.parts] == [[[0, 1, 2], [0, 2, 3]], [[4, 5, 6], [4, 6, 7]]]
    first = mesh.parts[0].corners
    assert first is not None
    assert first.tolist() == [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]


def test_a_plain_mesh(tmp_path: Path) -> None:
    mesh = MapReader(old.write_old(tmp_path / "map.db", (0, 13, 0))).mesh()
    assert mesh is not None
    assert [(part.triangles.tolist(), part.corners) for part in mesh.parts] == [([[0, 1, 2]], None)]
    assert mesh.textures is None


@pytest.mark.parametrize(
    ("statement", "blob", "says"),
    [
        ("opt_polygons = ?", z(np.array([[1, 0, 1, 99]], np.int32), 4), "among 20 points"),
        ("opt_polygons = ?", z(np.array([[9, 0, 1, 2]], np.int32), 4), "polygons are damaged"),
        ("opt_tex_coords = ?", z(np.array([[3, 0.5]], np.float32), 5), "coordinates are damaged"),
        ("opt_cloud = ?", z(np.zeros((1, 3, 8), np.float32), 61), "8 channels"),
        ("opt_polygons_size = 2, opt_cloud = coalesce(opt_cloud, ?)", b"", "2 corners"),
    ],
)
def test_damaged_meshes_are_refused(tmp_path: Path, statement: str, blob: bytes, says: str) -> None:
    reader = changed(tmp_path / "map.db", (f"UPDATE Admin SET {statement}", (blob,)))
    with pytest.raises(DatabaseError, match=says):
        reader.mesh()


def test_a_file_without_a_mesh_has_none(tmp_path: Path) -> None:
    read: tuple[Callable[[MapReader], object], ...] = (MapReader.mesh, MapReader.cloud, MapReader.preview)
    reader = MapReader(old.write_old(tmp_path / "old.db", (0, 10, 0)))
    assert [call(reader) for call in read] == [None, None, None]
