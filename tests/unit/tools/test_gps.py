"""GPS readings as text and on the earth, and the path of a map laid over them."""

from __future__ import annotations

import shutil
import sqlite3
import struct
from contextlib import closing
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from slam.database import MapReader
from slam.earth import TangentPlane
from slam.errors import DatabaseError
from slam.geometry import make, so3_exp, transform
from slam.tools.gps import export_gps
from slam.tools.poses import Format, export_landmarks, export_poses
from tests.tours import saved

ORIGIN = (8.55, 47.37, 410.0)
#: Where the map's own axes are on the ground.
T_ENU_MAP = make(so3_exp(np.array([0.0, 0.0, 1.1])), np.array([12.0, -5.0, 1.0]))


@pytest.fixture
def reader(tmp_path: Path) -> MapReader:
    """A map whose nodes had GPS as good as their optimised poses."""
    path = Path(shutil.copy(saved(0), tmp_path / "map.db"))
    poses, plane = MapReader(path).poses(), TangentPlane(*ORIGIN)
    with closing(sqlite3.connect(path)) as connection:
        for node_id, T in poses.items():
            lon, lat, alt = plane.to_geodetic(transform(T_ENU_MAP, T[None, :3, 3]))[0]
            blob = struct.pack("<6d", float(node_id), lon, lat, alt, 0.5, 90.0)
            connection.execute("UPDATE Node SET gps = ? WHERE id = ?", (blob, node_id))
        connection.commit()
    return MapReader(path)


def coordinates(path: Path) -> np.ndarray:
    text = ElementTree.parse(path).find(".//{http://www.opengis.net/kml/2.2}coordinates")
    assert text is not None
    assert text.text is not None
    return np.array([[float(v) for v in line.split(",")] for line in text.text.split()])


def test_readings_are_written_as_they_are_stored(reader: MapReader, tmp_path: Path) -> None:
    count = export_gps(reader, tmp_path / "gps.txt")
    rows = np.loadtxt(tmp_path / "gps.txt")
    assert len(rows) == count == len(reader.gps())
    first = reader.gps()[1]
    np.testing.assert_allclose(rows[0, :4], [first.stamp, first.longitude, first.latitude, first.altitude], atol=1e-3)
    export_gps(reader, tmp_path / "gps.kml")
    np.testing.assert_allclose(coordinates(tmp_path / "gps.kml")[:, :2], rows[:, 1:3], atol=1e-8)


def test_the_path_lies_on_its_readings(reader: MapReader, tmp_path: Path) -> None:
    export_poses(reader, tmp_path / "path.kml", Format.KML)
    measured = [(gps.longitude, gps.latitude, gps.altitude) for _, gps in sorted(reader.gps().items())]
    plane = TangentPlane(*ORIGIN)
    laid, truth = (plane.to_enu(np.asarray(rows)) for rows in (coordinates(tmp_path / "path.kml"), measured))
    np.testing.assert_allclose(laid, truth, atol=0.01)


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    reader = MapReader(saved(0))
    with pytest.raises(DatabaseError, match="no node has a GPS reading"):
        export_gps(reader, tmp_path / "gps.txt")
    with pytest.raises(DatabaseError, match="0 nodes with a pose have a GPS reading, and 3 are needed"):
        export_poses(reader, tmp_path / "path.kml", Format.KML)
    with pytest.raises(DatabaseError, match="no node saw a landmark"):
        export_landmarks(reader, tmp_path / "tags.txt")
    assert list(tmp_path.iterdir()) == []


def test_landmarks_are_where_they_were_seen(tmp_path: Path) -> None:
    path = Path(shutil.copy(saved(0), tmp_path / "map.db"))
    seen = make(so3_exp(np.array([0.0, 0.0, 0.3])), np.array([2.0, 0.5, 0.1]))
    insert = "INSERT INTO Link (from_id, to_id, type, information_matrix, transform) VALUES (2, -7, 8, ?, ?)"
    with closing(sqlite3.connect(path)) as connection:
        connection.execute(insert, (np.eye(6).tobytes(), seen[:3].astype("<f4").tobytes()))
        connection.commit()
    reader = MapReader(path)
    assert export_landmarks(reader, tmp_path / "tags.txt") == 1
    row = np.loadtxt(tmp_path / "tags.txt")
    assert row[0] == 7
    np.testing.assert_allclose(row[1:4], (reader.poses()[2] @ seen)[:3, 3], atol=1e-6)
