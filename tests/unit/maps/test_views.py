"""Nodes with several cameras, stereo pairs or a scanner alone have points as well."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from server.scene.node_points import node_points
from slam.database import MapReader
from slam.errors import SlamError, SourceError
from slam.maps.stereo import stereo_depth
from slam.maps.views import disparity_px, node_views
from tests.unit.database import old_files as old

FX, BASELINE, SHIFT = 100.0, 0.12, 8


def texture(width: int, height: int) -> NDArray[np.uint8]:
    """A surface that looks different everywhere."""
    noise = np.random.default_rng(5).integers(0, 255, (height, width, 3)).astype(np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 1.0).astype(np.uint8)


def pair() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Both images of a wall at one distance: what the right camera sees is ``SHIFT`` pixels farther left."""
    wide = texture(320 + SHIFT, 120)
    return wide[:, :-SHIFT].copy(), wide[:, SHIFT:].copy()


def test_a_wall_is_at_its_distance() -> None:
    depth_m = stereo_depth(*pair(), FX, BASELINE)
    known = depth_m > 0
    assert known.mean() > 0.5
    np.testing.assert_allclose(np.median(depth_m[known]), FX * BASELINE / SHIFT, rtol=0.01)


@pytest.mark.parametrize(("right", "baseline", "says"), [(pair()[1][:50], 0.1, "one size"), (pair()[1], 0.0, "0 m")])
def test_what_is_no_pair_is_refused(right: NDArray[np.uint8], baseline: float, says: str) -> None:
    with pytest.raises(SourceError, match=says):
        stereo_depth(pair()[0], right, FX, baseline)


def test_each_camera_has_its_tile(tmp_path: Path) -> None:
    version = (0, 18, 0)
    two = old.calibration_of(version, cameras=2)
    reader = MapReader(old.write_old(tmp_path / "two.db", version, calibration=two))
    left, right = node_views(reader, 1)
    np.testing.assert_array_equal(np.hstack([left.image_bgr, right.image_bgr]), old.IMAGE)
    np.testing.assert_allclose(np.hstack([left.depth_m, right.depth_m]), old.DEPTH_MM / 1000, atol=1e-6)
    assert (left.camera.width, right.camera.width) == (32, 32)
    points = node_points(reader, 1, np.eye(4), 4000, images=True)
    one = MapReader(old.write_old(tmp_path / "one.db", version, calibration=old.calibration_of(version)))
    assert len(points.points) > 0.8 * len(node_points(one, 1, np.eye(4), 4000, images=True).points)


def test_stereo_pairs_have_depth(tmp_path: Path) -> None:
    left, right = pair()
    calibration = np.array([FX, FX, 160, 60, BASELINE, 320, 120, *old.LOCAL.ravel()], "<f4").tobytes()
    path = old.write_old(tmp_path / "stereo.db", (0, 17, 6), calibration=calibration, depth=old.png(right))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Data SET image = ?", (old.png(left),))
        connection.commit()
    (view,) = node_views(MapReader(path), 1)
    disparity = disparity_px(view, BASELINE)
    assert ((disparity > 0) == (view.depth_m > 0)).all()
    assert np.median(disparity[disparity > 0]) == pytest.approx(SHIFT, rel=0.01)
    cloud = node_points(MapReader(path), 1, np.eye(4), 4000, images=True)
    assert np.median(cloud.points[:, 0]) == pytest.approx(FX * BASELINE / SHIFT + old.LOCAL[0, 3], rel=0.02)


def test_a_scanner_alone_has_points(tmp_path: Path) -> None:
    reader = MapReader(old.write_old(tmp_path / "scan.db", (0, 11, 13)))
    cloud = node_points(reader, 1, np.eye(4), 4000, images=False)
    assert len(cloud.points) == len(cloud.colours) == len(old.SCAN)
    assert reader.nodes_with("scan").tolist() == [1, 2]
    with pytest.raises(SlamError, match="neither images nor a scan"):
        node_points(reader, 3, np.eye(4), 4000, images=False)
