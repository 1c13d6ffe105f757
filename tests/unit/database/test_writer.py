"""The writer, seen through the reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slam.database import MapReader, MapWriter, NodeRecord
from slam.params import Params
from tests.unit.database.map_records import frames, record, records, write_map


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
