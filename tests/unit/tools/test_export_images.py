"""Images of a map as a folder."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from slam.database import MapReader
from slam.errors import DatabaseError
from slam.sensors import open_source
from slam.tools.images import export_images
from tests.tours import saved


def test_the_folder_is_a_source_with_the_same_frames(tmp_path: Path) -> None:
    reader = MapReader(saved(0, 6))
    assert export_images(reader, tmp_path / "out") == 6
    source = open_source(tmp_path / "out")
    camera = reader.camera(1)
    assert (source.camera.fx, source.camera.cy, source.camera.width) == (camera.fx, camera.cy, camera.width)
    for frame, node_id in zip(source, reader.node_ids().tolist(), strict=True):
        assert np.array_equal(frame.image_bgr, reader.image_bgr(node_id))
        np.testing.assert_allclose(frame.depth_m, reader.depth_m(node_id), atol=1e-6)
        assert frame.T_world_base is not None


def test_the_camera_is_readable_by_opencv_with_its_place(tmp_path: Path) -> None:
    export_images(MapReader(saved(0, 6)), tmp_path / "out")
    storage = cv2.FileStorage(str(tmp_path / "out" / "camera.yaml"), cv2.FILE_STORAGE_READ)
    data = storage.getNode("local_transform").getNode("data")
    T = np.array([data.at(k).real() for k in range(12)]).reshape(3, 4)
    np.testing.assert_allclose(T, MapReader(saved(0, 6)).camera(1).T_base_cam[:3], atol=1e-6)
    assert storage.getNode("image_width").real() == 320


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(DatabaseError, match="is not empty"):
        export_images(MapReader(saved(0, 6)), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
