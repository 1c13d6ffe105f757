"""Files that C++ RTAB-Map wrote, read whole; skipped where they are absent."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slam.database import JournalEntry, MapReader, MapWriter
from slam.database.blobs import pack_information, pack_transform, unpack_transform
from slam.database.calibration import pack_camera
from slam.database.depth_codec import MAGIC, decode_rvl, encode_rvl
from slam.geometry import between, from_quat_xyzw, inverse, make, rotation_angle, transform, translation_norm
from slam.params import Params
from slam.types import WEIGHT_INVALID, LinkType
from tests.unit.database.map_records import record

CPP = ("cpp_0.23.8_toyroom", "cpp_0.23.8_tum_fr1_xyz_excerpt")


@pytest.fixture(params=CPP)
def cpp(request: pytest.FixtureRequest, shared_data: Path) -> Path:
    """A file of RTAB-Map 0.23.8."""
    return shared_data / "rtabmap_db" / f"{request.param}.db"


def one(path: Path, query: str) -> list[tuple[Any, ...]]:
    """Rows of a query, through plain SQLite."""
    connection = sqlite3.connect(f"file:{path}?immutable=1", uri=True)
    try:
        return connection.execute(query).fetchall()
    finally:
        connection.close()


def test_every_file_can_be_read(shared_data: Path) -> None:
    files = sorted((shared_data / "rtabmap_db").rglob("*.db"))
    assert len(files) >= 9
    for path in files:
        reader = MapReader(path)
        info = reader.info()
        assert info.version == one(path, "SELECT version FROM Admin")[0][0]
        assert info.nodes + info.dropped == len(reader.nodes()) == len(reader.node_ids())
        assert sum(info.links.values()) == len(reader.links())
        assert info.words == len(reader.words())
        assert info.features == sum(len(reader.features(int(i))[1]) for i in reader.node_ids())
        assert [reader.journal(), reader.candidates(), reader.updates(), reader.trajectory()] == [[], [], [], []]
        assert reader.hypotheses(1) is None
        for i in reader.nodes_with("image"):
            assert reader.image_bgr(int(i)).shape[2] == 3
        for i in reader.nodes_with("depth"):
            depth_m, camera = reader.depth_m(int(i)), reader.camera(int(i))
            assert depth_m.shape == (camera.height, camera.width)
            assert 0 <= depth_m.min() < depth_m.max() < 20
        for i in reader.node_ids():
            reader.local_grid(int(i))


def test_optimised_poses_are_those_it_printed(cpp: Path) -> None:
    """The list is of the camera in the frame of motion capture data: x right, y forward, z up."""
    reader = MapReader(cpp)
    printed = np.loadtxt(cpp.with_name(f"{cpp.stem}_poses.txt"))
    T_mocap_map = make(np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]), np.zeros(3))
    poses, nodes = reader.poses(), reader.nodes()
    stamps = dict(zip(nodes.ids.tolist(), nodes.stamps.tolist(), strict=True))
    assert len(poses) == len(printed)
    for line, (node_id, T_map_base) in zip(printed, sorted(poses.items()), strict=True):
        T_mocap_cam = T_mocap_map @ T_map_base @ reader.camera(node_id).T_base_cam
        assert stamps[node_id] == pytest.approx(line[0], abs=1e-5)
        np.testing.assert_allclose(T_mocap_cam[:3, 3], line[1:4], atol=2e-6)
        if node_id > 1:  # the first is printed as the map frame itself
            assert rotation_angle(between(T_mocap_cam, from_quat_xyzw(line[4:], np.zeros(3)))) < 1e-4


def test_the_graph_is_all_there(cpp: Path) -> None:
    reader = MapReader(cpp)
    nodes = reader.nodes()
    kept = nodes.ids[nodes.weights != WEIGHT_INVALID]
    assert reader.info().dropped == int(np.sum(nodes.weights == WEIGHT_INVALID))
    assert nodes.labels[0] == "map0"
    assert np.isfinite(nodes.T_odom).all()
    links = reader.links()
    rows = one(cpp, "SELECT from_id, to_id, type, information_matrix, transform FROM Link WHERE from_id > to_id")
    assert {(link.from_id, link.to_id, int(link.type)) for link in links} == {row[:3] for row in rows}
    stored = {row[:2]: row[3:] for row in rows}
    for link in links:
        assert (pack_information(link.information), pack_transform(link.T_from_to)) == stored[link.from_id, link.to_id]
    neighbors = [link for link in links if link.type == LinkType.NEIGHBOR]
    assert len(neighbors) == len(kept) - 1
    poses = reader.poses()
    assert set(poses) == set(kept.tolist())
    for link in neighbors:
        assert link.T_from_to is not None
        optimised = between(poses[link.from_id], poses[link.to_id])
        assert translation_norm(between(link.T_from_to, optimised)) < 0.1


def test_reverse_rows_are_the_inverse_with_the_same_information(cpp: Path) -> None:
    query = "SELECT from_id, to_id, information_matrix, transform FROM Link"
    rows = {row[:2]: row[2:] for row in one(cpp, query)}
    for (from_id, to_id), (information, blob) in rows.items():
        reverse = rows[to_id, from_id]
        assert reverse[0] == information
        T_from_to, T_to_from = unpack_transform(blob), unpack_transform(reverse[1])
        assert T_from_to is not None
        assert T_to_from is not None
        np.testing.assert_allclose(T_to_from, inverse(T_from_to), atol=1e-6)


def test_depth_and_calibration_are_encoded_as_it_encodes_them(cpp: Path) -> None:
    reader = MapReader(cpp)
    for node_id in reader.nodes_with("depth").tolist():
        blob = reader.depth(node_id)
        assert blob.startswith(MAGIC)
        assert encode_rvl(decode_rvl(blob)) == blob
    for node_id, calibration in one(cpp, "SELECT id, calibration FROM Data"):
        assert isinstance(node_id, int)
        assert isinstance(calibration, bytes)
        assert pack_camera(reader.camera(node_id))[12:] == calibration[12:]  # the first 12 are the writer's version


def test_key_points_lie_in_the_image_at_their_depth(cpp: Path) -> None:
    reader = MapReader(cpp)
    words = set(reader.words().ids.tolist())
    nodes = reader.nodes()
    for node_id in nodes.ids[nodes.weights != WEIGHT_INVALID][::9].tolist():
        features, word_ids = reader.features(node_id)
        camera, depth_m = reader.camera(node_id), reader.depth_m(node_id)
        assert features.descriptors.shape == (len(features), 32)
        assert set(word_ids[word_ids > 0].tolist()) <= words
        seen = np.isfinite(features.points_base[:, 0])
        assert seen.mean() > 0.5
        points_cam = transform(inverse(camera.T_base_cam), features.points_base[seen])
        off = np.linalg.norm(camera.project(points_cam) - features.pixels[seen], axis=1)
        assert np.median(off) < 1e-2
        u, v = np.rint(features.pixels[seen]).astype(int).T
        there = depth_m[np.clip(v, 0, camera.height - 1), np.clip(u, 0, camera.width - 1)]
        assert np.median(np.abs(there - points_cam[:, 2])) < 0.02


def test_statistics_and_working_memory(cpp: Path) -> None:
    reader = MapReader(cpp)
    columns = reader.statistics()
    assert columns.ids.tolist() == reader.node_ids().tolist()
    assert {"Timing/Total/ms", "Loop/Highest_hypothesis_value/", "Memory/Short_time_memory_size/"} <= set(
        columns.values
    )
    assert reader.statistic_names() == sorted(columns.values)
    sizes = columns.values["Memory/Working_memory_size/"] + columns.values["Memory/Short_time_memory_size/"]
    states = reader.wm_states()
    assert [len(states[i]) for i in columns.ids[1:].tolist()] == sizes[1:].astype(int).tolist()
    few = reader.statistics(ids=[3, 7], names=["Timing/Total/ms", "No/Such/"])
    assert few.ids.tolist() == [3, 7]
    assert np.isfinite(few.values["Timing/Total/ms"]).all()
    assert np.isnan(few.values["No/Such/"]).all()
    assert reader.statistics(after=40).ids.tolist() == columns.ids[columns.ids > 40].tolist()


def test_parameters(cpp: Path) -> None:
    reader = MapReader(cpp)
    assert reader.parameters()["Mem/STMSize"] == "8"
    assert reader.info().parameters["Mem/STMSize"] == "8"
    assert len(reader.parameters()) > 400
    assert reader.info().clean


def test_local_grids_are_in_front_of_the_camera(shared_data: Path) -> None:
    grid = MapReader(shared_data / "rtabmap_db" / "cpp_0.23.8_tum_fr1_xyz_excerpt.db").local_grid(1)
    assert grid is not None
    assert grid.cell_size == pytest.approx(0.05)
    cells = np.vstack([grid.obstacles, grid.empty])
    assert len(cells) > 100
    assert (cells[:, 0] > -0.05).mean() > 0.99


def test_the_minimal_file_of_the_recipe(shared_data: Path) -> None:
    """It has a landmark, gravity, a 2D map and 16-bit PNG depth."""
    reader = MapReader(shared_data / "rtabmap_db" / "minimal_0_20.db")
    assert reader.info().links == {"Neighbor": 4, "GlobalClosure": 1, "Landmark": 1, "Gravity": 1}
    grid = reader.grid()
    assert grid is not None
    assert set(np.unique(grid.cells)) <= {-1, 0, 100}
    assert reader.depth(1).startswith(b"\x89PNG")


def test_an_unclean_file_is_known_by_its_first_info_row(shared_data: Path) -> None:
    (path,) = (shared_data / "rtabmap_db").glob("Strroke21*.db")
    info = MapReader(path).info()
    assert (info.clean, info.nodes, info.dropped, info.links) == (False, 50, 361, {"Neighbor": 49})


def test_a_file_of_rtabmap_can_be_corrected_and_continued(cpp: Path, tmp_path: Path) -> None:
    path = Path(shutil.copy(cpp, tmp_path / "copy.db"))
    before = MapReader(path)
    links, poses, memory = before.links(), before.poses(), before.memory_ids()
    loop = next(link for link in links if link.type == LinkType.GLOBAL_CLOSURE)
    with MapWriter.open(path) as writer:
        entry = JournalEntry(action="reject", from_id=loop.from_id, to_id=loop.to_id, author="me", link_before=loop)
        writer.append_decision(entry, remove=[loop.pair], poses=poses)
    after = MapReader(path)
    assert {link.pair for link in after.links()} == {link.pair for link in links} - {loop.pair}
    assert after.journal()[0].link_before is not None
    assert after.grid() is None
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Admin SET dictionary_index = x'01'")
        connection.commit()
    with MapWriter.open(path) as writer:
        map_id = writer.start_session(Params(), seed=0, source="more")
        new_id = int(before.node_ids().max()) + 1
        writer.add_node(record(new_id, map_id=map_id, links=(), new_words=0, poses={}))
    assert map_id == 1
    assert one(path, "SELECT dictionary_index FROM Admin") == [(None,)]
    nodes, words = MapReader(path).memory_ids()
    assert nodes.tolist() == [*memory[0].tolist(), new_id]
    assert words.tolist() == memory[1].tolist()
    assert [session.map_id for session in MapReader(path).sessions()] == [0, 1]
