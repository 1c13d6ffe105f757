"""The writer, seen through the reader."""

from __future__ import annotations

import sqlite3
import zlib
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slam.database import MapReader, MapWriter, NodeRecord, WordRows
from slam.errors import DatabaseError, ParameterError
from slam.params import Params
from slam.types import WEIGHT_INVALID
from tests.unit.database.map_records import frames, pose, record, records, write_map


def assert_same_node(reader: MapReader, expected: NodeRecord) -> None:
    """All of a record, read back; poses and transforms within float32, sizes cut to whole pixels."""
    node = expected.node
    row = reader.node(node.id)
    assert (row.id, row.map_id, row.weight, row.stamp) == (node.id, node.map_id, node.weight, node.stamp)
    assert row.T_odom_base is not None
    assert row.T_world_base is not None
    assert node.T_world_base is not None
    np.testing.assert_array_equal(row.T_odom_base, node.T_odom_base.astype(np.float32))
    np.testing.assert_array_equal(row.T_world_base, node.T_world_base.astype(np.float32))
    found, word_ids = reader.features(node.id)
    np.testing.assert_array_equal(word_ids, node.word_ids)
    for name in ("pixels", "sizes", "angles", "responses", "octaves", "descriptors"):
        np.testing.assert_array_equal(getattr(found, name), getattr(node.features, name), err_msg=name)
    known = np.isfinite(node.features.points_base).all(axis=1)
    np.testing.assert_array_equal(found.points_base[known], node.features.points_base[known])
    assert np.isnan(found.points_base[~known]).all()
    assert expected.depth_m is not None
    np.testing.assert_allclose(reader.depth_m(node.id), expected.depth_m, atol=5e-4)
    camera = reader.camera(node.id)
    np.testing.assert_array_equal(camera.K, node.camera.K)
    assert (camera.width, camera.height) == (node.camera.width, node.camera.height)
    np.testing.assert_array_equal(camera.T_base_cam, node.camera.T_base_cam)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    reader = MapReader(write_map(tmp_path / "map.db", 5))
    assert reader.node_ids().tolist() == [1, 2, 3, 4, 5]
    for expected in records(5):
        assert_same_node(reader, expected)


def test_float_descriptors_come_back_as_floats(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    made = record(1)
    numbers = np.random.default_rng(0).normal(size=(40, 64)).astype(np.float32)
    node = replace(made.node, features=replace(made.node.features, descriptors=numbers))
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        writer.add_node(replace(made, node=node, words=WordRows(made.words.ids, numbers[:10])))
        assert_same_node(MapReader(path), replace(made, node=node))
        words = MapReader(path).words()
    assert words.descriptors.dtype == np.float32
    np.testing.assert_array_equal(words.descriptors, numbers[:10])
    with closing(sqlite3.connect(path)) as file:
        sizes = file.execute("SELECT DISTINCT descriptor_size, length(descriptor) FROM Feature").fetchall()
        assert sizes == file.execute("SELECT DISTINCT descriptor_size, length(descriptor) FROM Word").fetchall()
    assert sizes == [(64, 256)], "RTAB-Map tells floats by four bytes for each of descriptor_size"


def test_png_images_are_lossless(tmp_path: Path) -> None:
    params = Params().changed({"Mem/ImageCompressionFormat": ".png", "Mem/DepthCompressionFormat": ".png"})
    reader = MapReader(write_map(tmp_path / "map.db", 1, params))
    np.testing.assert_array_equal(reader.image_bgr(1), record(1).image_bgr)
    assert reader.image(1).startswith(b"\x89PNG")
    assert reader.depth(1).startswith(b"\x89PNG")


def test_frames_at_the_end_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        writer.add_frames(frames(2))
    assert [frame.index for frame in MapReader(path).trajectory()] == [2, 3, 4, 5]


def test_the_rest_of_a_record_is_read_too(tmp_path: Path) -> None:
    reader = MapReader(write_map(tmp_path / "map.db", 3))
    expected = record(3)
    grid, found = expected.grid, reader.local_grid(3)
    assert grid is not None
    assert found is not None
    for name in ("ground", "obstacles", "empty"):
        np.testing.assert_array_equal(getattr(found, name), getattr(grid, name))
    assert (found.cell_size, found.view_point) == (grid.cell_size, grid.view_point)
    grid_map, stored = expected.grid_map, reader.grid()
    assert grid_map is not None
    assert stored is not None
    np.testing.assert_array_equal(stored.cells, grid_map.cells)
    assert (stored.x_min, stored.y_min, stored.cell_size) == (grid_map.x_min, grid_map.y_min, grid_map.cell_size)
    assert reader.statistics(ids=[3]).values["Loop/Highest_hypothesis_value/"].tolist() == [0.375]
    assert reader.wm_states(after=2)[3].tolist() == [1, 2, 3]
    words = reader.words()
    np.testing.assert_array_equal(words.descriptors[words.ids >= 3000], expected.words.descriptors)
    assert reader.words([3001, 1, 3002]).ids.tolist() == [3001, 3002]
    poses = reader.poses()
    assert sorted(poses) == [1, 2, 3]
    np.testing.assert_array_equal(poses[2], pose(2).astype(np.float32))
    last = reader.last_pose()
    assert last is not None
    np.testing.assert_array_equal(last, pose(3).astype(np.float32))


def test_what_a_later_update_changes(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        for i in (1, 2):
            writer.add_node(record(i))
        writer.add_node(record(3, weights={1: 0, 2: 9}, grid_map=None))
        writer.update_nodes({3: 4})
        writer.save_poses({2: pose(8), 1: pose(7)}, None)
        reader = MapReader(path)
        with closing(sqlite3.connect(path)) as connection:
            (ids,) = connection.execute("SELECT opt_ids FROM Admin").fetchone()
        assert zlib.decompress(ids[:-12]) == np.array([1, 2], dtype="<i4").tobytes()  # ascending
        np.testing.assert_array_equal(reader.poses()[1], pose(7).astype(np.float32))
        assert reader.nodes().weights.tolist() == [0, 9, 4]
        assert sorted(reader.poses()) == [1, 2]
        last = reader.last_pose()
        assert last is not None
        np.testing.assert_array_equal(last, pose(3).astype(np.float32))
        assert reader.grid() is not None
        writer.save_grid(None)
        assert reader.grid() is None
        with pytest.raises(DatabaseError, match="weight 1 of node 9 can't be stored: there is no such node"):
            writer.update_nodes({1: 1, 9: 1})
    assert MapReader(path).nodes().weights.tolist() == [0, 9, 4]


def test_parameters_changed_while_running_are_logged_and_obeyed(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        writer.parameter_change(1, "Mem/ImageCompressionFormat", ".png")
        writer.parameter_change(1, "Rtabmap/LoopThr", 0.3)
        with pytest.raises(ParameterError, match="unknown parameter 'Rtabmap/LoopTr'"):
            writer.parameter_change(1, "Rtabmap/LoopTr", 0.3)
        writer.add_node(record(2))
    reader = MapReader(path)
    changes = [(change.node_id, change.name, change.value) for change in reader.parameter_changes()]
    assert changes == [(1, "Mem/ImageCompressionFormat", ".png"), (1, "Rtabmap/LoopThr", "0.3")]
    assert [reader.image(i)[:2] for i in (1, 2)] == [b"\xff\xd8", b"\x89P"]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"map_id": 1}, "belongs to session 1, and session 0 runs"),
        ({"node_id": 1}, "ids are positive and used once"),
        ({"node_id": -3}, "ids are positive and used once"),
        ({"words": WordRows(np.array([1001], np.int32), np.zeros((1, 32), np.uint8))}, "not used yet"),
        ({"words": WordRows(np.array([0], np.int32), np.zeros((1, 32), np.uint8))}, "must be positive"),
        ({"words": WordRows(np.array([5, 5], np.int32), np.zeros((2, 32), np.uint8))}, "not used yet"),
        ({"words": WordRows.none()}, "refers to 10 words that are not in the dictionary, first 2001"),
        ({"weights": {77: 1}}, "weight 1 of node 77"),
        ({"statistics": {"a:b": 1.0}}, "statistic 'a:b' can't be stored"),
    ],
)
def test_what_does_not_fit_the_map_is_refused_whole(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        before = MapReader(path).info()
        bad = record(2, map_id=changes.pop("map_id", 0), **{k: v for k, v in changes.items() if k != "node_id"})
        if "node_id" in changes:
            bad = replace(bad, node=replace(bad.node, id=changes["node_id"]))
        with pytest.raises(DatabaseError, match=f"map.db: adding node {bad.node.id} failed: .*{says}"):
            writer.add_node(bad)
        assert replace(MapReader(path).info(), size_bytes=0) == replace(before, size_bytes=0)
        writer.add_node(record(2))
    assert MapReader(path).node_ids().tolist() == [1, 2]


def test_key_points_that_the_table_refuses(tmp_path: Path) -> None:
    """Angles and responses that are no numbers are stored as none and 0; pixels that are none are refused."""
    path = tmp_path / "map.db"
    good = record(1)
    features = good.node.features
    features.angles[:3], features.responses[3:5], features.points_base[6, 1] = np.nan, np.nan, np.inf
    features.sizes[5] = 7.9
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(good)
        broken = record(2)
        broken.node.features.pixels[4, 0] = np.nan
        with pytest.raises(DatabaseError, match="a key point whose pixel is not a number"):
            writer.add_node(broken)
        short = record(2)
        with pytest.raises(DatabaseError, match="40 key points and 39 word ids"):
            writer.add_node(replace(short, node=replace(short.node, word_ids=short.node.word_ids[:-1])))
    found, _ = MapReader(path).features(1)
    assert found.angles[:3].tolist() == [-1.0, -1.0, -1.0]
    assert found.responses[3:5].tolist() == [0.0, 0.0]
    assert found.sizes[5] == 7.0
    assert np.isnan(found.points_base[6]).all()


def test_a_node_without_key_points_image_depth_or_grid(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    bare = record(1, count=0, new_words=0, image_bgr=None, depth_m=None, grid=None, statistics={}, frames=())
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(bare)
    reader = MapReader(path)
    row = reader.node(1)
    assert (row.features, row.words, row.image_bytes, row.depth_bytes, row.has_grid) == (0, 0, 0, 0, False)
    features, word_ids = reader.features(1)
    assert (len(features), len(word_ids), features.descriptors.shape[0]) == (0, 0, 0)
    assert reader.statistics().ids.tolist() == [1]
    assert reader.info().first_stamp == 101.0


def test_a_dropped_node_may_have_words_that_the_dictionary_forgot(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    dropped = record(1, words=WordRows.none())
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(replace(dropped, node=replace(dropped.node, weight=WEIGHT_INVALID)))
    assert MapReader(path).info().words == 0


def test_using_a_writer_out_of_turn(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db", 1)
    with MapWriter.open(path) as writer:
        for use in (lambda: writer.add_node(record(2)), lambda: writer.add_frames(frames(1)), lambda: writer.map_id):
            with pytest.raises(DatabaseError, match="no session runs: start one before"):
                use()
    with pytest.raises(DatabaseError, match=r"map\.db is closed: changing weights is not possible any more"):
        writer.update_nodes({1: 3})
    writer.close()


def test_a_file_whose_program_failed_is_plain_but_not_clean(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with pytest.raises(ZeroDivisionError), MapWriter.create(path, Params(), seed=3, source="x") as writer:
        writer.add_node(record(1))
        raise ZeroDivisionError
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]
    info = MapReader(path).info()
    assert (info.clean, info.seeds, info.sources) == (False, (3,), ("x",))


def test_words_of_older_nodes_become_others(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
        writer.add_node(record(2))
        renamed = {1: {1001: 3001, 1002: 1003, 1003: 2005, 77: 1004}}
        with pytest.raises(DatabaseError, match="words of older nodes can't become 9999"):
            writer.add_node(record(3, renamed_words={1: {1001: 9999}}))
        writer.add_node(record(3, renamed_words=renamed))
    expected = record(1).node.word_ids.copy()
    expected[:3] = [3001, 1003, 2005]
    assert MapReader(path).features(1)[1].tolist() == expected.tolist()
    assert MapReader(path).features(2)[1].tolist() == record(2).node.word_ids.tolist()
