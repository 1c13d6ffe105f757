"""Clouds as RTAB-Map's laser scans: what is written is read, and each of its formats has its points."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.database import MapReader, MapWriter
from slam.database.blobs import pack_matrix, pack_row
from slam.database.scans import pack_scan, pack_scan_info, unpack_scan, unpack_stored_scan
from slam.errors import DatabaseError
from slam.geometry import make, so3_exp, transform
from slam.params import Params
from slam.types import Scan
from tests.unit.database.map_records import record

POINTS = np.random.default_rng(0).normal(size=(40, 7)).astype(np.float32)


def info(kind: int, T_base_scan: NDArray[np.float64] | None = None) -> bytes:
    pose = np.eye(4) if T_base_scan is None else T_base_scan
    return np.concatenate([[kind, 0, 0, 0, 0, 0, 40], pose[:3].reshape(-1)]).astype("<f4").tobytes()


@pytest.mark.parametrize("normals", [False, True])
def test_what_is_written_is_read_bit_for_bit(tmp_path: Path, normals: bool) -> None:
    scan = Scan(POINTS[:, :3], POINTS[:, 3:6] if normals else None)
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        item = record(1)
        writer.add_node(replace(item, node=replace(item.node, scan=scan)))
        writer.add_node(record(2))
    reader = MapReader(path)
    found = reader.scan(1)
    assert found is not None
    np.testing.assert_array_equal(found.points_base, scan.points_base)
    assert (found.normals_base is None) == (not normals)
    if normals:
        np.testing.assert_array_equal(found.normals_base, POINTS[:, 3:6])
    assert reader.scan(2) is None


@pytest.mark.parametrize(
    ("kind", "channels", "solid", "normal"),
    [
        (1, 2, False, 0),
        (2, 3, False, 0),
        (3, 5, False, 2),
        (4, 6, False, 3),
        (5, 3, True, 0),
        (6, 4, True, 0),
        (7, 4, True, 0),
        (8, 6, True, 3),
        (9, 7, True, 4),
        (10, 7, True, 4),
        (11, 5, True, 0),
        (12, 6, True, 0),
    ],
)
def test_every_format_has_its_points(kind: int, channels: int, solid: bool, normal: int) -> None:
    found = unpack_scan(pack_row(POINTS[:, :channels]), info(kind))
    assert found is not None
    np.testing.assert_array_equal(found.points_base[:, :2], POINTS[:, :2])
    np.testing.assert_array_equal(found.points_base[:, 2], POINTS[:, 2] if solid else 0)
    assert (found.normals_base is None) == (normal == 0)
    if found.normals_base is not None:
        np.testing.assert_array_equal(found.normals_base, POINTS[:, normal : normal + 3])


def test_the_scanner_s_place_and_holes_are_seen_to() -> None:
    T_base_scan = make(so3_exp(np.array([0.1, 0.2, 0.3])), np.array([0.5, 0.0, 1.0]))
    rows = POINTS[:, :6].copy()
    rows[3, 1] = np.nan
    organised = rows.reshape(4, 10, 6)
    found = unpack_scan(pack_matrix(organised), info(8, T_base_scan))
    assert found is not None
    whole = np.delete(rows, 3, axis=0)
    np.testing.assert_allclose(found.points_base, transform(T_base_scan, whole[:, :3]), atol=1e-5)
    assert found.normals_base is not None
    np.testing.assert_allclose(found.normals_base, whole[:, 3:] @ T_base_scan[:3, :3].T, atol=1e-5)


def test_without_information_channels_tell_the_format() -> None:
    found = unpack_scan(pack_row(POINTS[:, :3]), None)
    assert found is not None
    np.testing.assert_array_equal(found.points_base, POINTS[:, :3])
    assert unpack_scan(None, info(5)) is None


@pytest.mark.parametrize(
    ("blob", "about", "says"),
    [
        (pack_row(POINTS[:, :3]), info(99), "format 99"),
        (pack_row(POINTS[:, :2]), info(5), "2 channels"),
        (pack_row(POINTS[:, :3]), info(5)[:20], "5 numbers"),
    ],
)
def test_what_no_scan_is_is_refused(blob: bytes, about: bytes, says: str) -> None:
    with pytest.raises(DatabaseError, match=says):
        unpack_scan(blob, about)


def test_rtabmap_s_own_scans_are_read(shared_data: Path) -> None:
    reader = MapReader(shared_data / "rtabmap_db" / "minimal_0_20.db")
    found = [reader.scan(i) for i in reader.node_ids().tolist()]
    assert all(scan is not None and len(scan) == 200 for scan in found)


def test_the_information_is_as_long_as_rtabmap_wants_it() -> None:
    blob, about = pack_scan(Scan(POINTS[:, :3]))
    numbers = np.frombuffer(about, "<f4")
    assert len(numbers) == 19
    assert numbers[0] == 5
    assert numbers[6] == 40
    np.testing.assert_array_equal(numbers[7:], np.eye(4)[:3].reshape(-1))
    assert blob is not None
    assert np.frombuffer(blob[-12:], "<i4").tolist() == [1, 40, 5 + 8 * 2]


@pytest.mark.parametrize(
    ("kind", "channels", "intensity", "colour"),
    [(2, 3, 2, 0), (4, 6, 2, 0), (6, 4, 3, 0), (7, 4, 0, 3), (9, 7, 3, 0), (10, 7, 0, 3), (12, 6, 3, 0), (8, 6, 0, 0)],
)
def test_what_is_stored_of_each_point_is_told_beside_it(kind: int, channels: int, intensity: int, colour: int) -> None:
    rows = np.random.default_rng(kind).uniform(0, 1, (6, channels)).astype(np.float32)
    rows[2, 0] = np.nan
    bits = np.arange(6, dtype=np.uint32) * 0x010203
    if colour:
        rows[:, colour] = bits.view(np.float32)
    scanner = np.frombuffer(pack_scan_info(kind, 360, np.eye(4), range_max=8.0), "<f4").copy()
    scanner[1], scanner[3:6] = 0.5, (-1.0, 1.0, 0.25)
    found = unpack_stored_scan(pack_row(rows), scanner.tobytes())
    assert found is not None and len(found.scan) == 5, "a hole is no point"
    assert (found.range_m, found.angles_rad, found.most) == ((0.5, 8.0), (-1.0, 1.0, 0.25), 360)
    kept = [0, 1, 3, 4, 5]
    assert (found.intensities is None) == (intensity == 0)
    if found.intensities is not None:
        np.testing.assert_array_equal(found.intensities, rows[kept, intensity])
    assert (found.colours is None) == (colour == 0)
    if found.colours is not None:
        assert found.colours.tolist() == [[i, 2 * i, 3 * i] for i in kept]
