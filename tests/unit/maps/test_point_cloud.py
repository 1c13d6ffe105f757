"""Point clouds: where pixels end up, how clouds join, what a PLY holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.camera import Camera
from slam.errors import DatabaseError, SourceError
from slam.geometry import make
from slam.maps.point_cloud import assemble, node_cloud, write_ply
from tests.rooms import CAMERA, render, tilted

IMAGE = np.random.default_rng(0).integers(0, 255, (480, 640, 3), dtype=np.uint8)


def test_points_lie_on_the_walls_in_the_base_frame() -> None:
    points, colors = node_cloud(IMAGE, render(tilted(), wall=3.0), CAMERA, 4)
    assert points.dtype == np.float32
    assert colors.dtype == np.uint8
    assert points.shape == colors.shape == (120 * 160, 3)
    on_wall = np.abs(points[:, 0] - 3.0) < 1e-4
    on_floor = np.abs(points[:, 2] + 1.0) < 1e-4
    assert np.all(on_wall | on_floor)
    assert on_wall.any()
    assert on_floor.any()


def test_each_point_has_the_colour_of_its_pixel_red_first() -> None:
    depth = np.zeros((480, 640), np.float32)
    depth[100, 200] = 2.0
    points, colors = node_cloud(IMAGE, depth, CAMERA)
    assert np.array_equal(colors, [IMAGE[100, 200, ::-1]])
    assert np.allclose(CAMERA.project(points @ CAMERA.T_base_cam[:3, :3]), [[200, 100]], atol=1e-3)


def test_unknown_and_far_depth_give_no_point() -> None:
    depth = np.array([[0.0, np.nan], [1.0, 9.0]], np.float32)
    camera = Camera(2, 2, 2.0, 2.0, 0.5, 0.5)
    assert len(node_cloud(IMAGE[:2, :2], depth, camera)[0]) == 2
    assert len(node_cloud(IMAGE[:2, :2], depth, camera, max_depth_m=5.0)[0]) == 1


def test_a_smaller_depth_image_covers_the_same_view() -> None:
    depth = render(tilted(), wall=3.0)
    small = render(tilted(), wall=3.0).reshape(120, 4, 160, 4).mean(axis=(1, 3)).astype(np.float32)
    full, half = node_cloud(IMAGE, depth, CAMERA)[0], node_cloud(IMAGE, small, CAMERA)[0]
    assert np.allclose(full.min(axis=0), half.min(axis=0), atol=0.03)
    assert np.allclose(full.max(axis=0), half.max(axis=0), atol=0.03)


def test_images_that_do_not_show_the_same_are_refused() -> None:
    with pytest.raises(SourceError, match="640x300 with a colour image of 640x480"):
        node_cloud(IMAGE, np.ones((300, 640), np.float32), CAMERA)


def test_clouds_meet_in_the_map_frame() -> None:
    points = np.array([[1.0, 0.0, 0.0]], np.float32)
    red, blue = np.array([[200, 0, 0]], np.uint8), np.array([[0, 0, 100]], np.uint8)
    moved = make(np.eye(3), np.array([2.0, 0.0, 0.0]))
    where, colors = assemble([(np.eye(4), points + np.float32([2, 0, 0]), red), (moved, points, blue)], 0.1)
    assert np.allclose(where, [[3.0, 0.0, 0.0]])
    assert np.array_equal(colors, [[100, 0, 50]])
    assert len(assemble([], 0.1)[0]) == 0


def test_ply_holds_what_was_written(tmp_path: Path) -> None:
    points = np.random.default_rng(1).normal(size=(7, 3)).astype(np.float32)
    colors = np.arange(21, dtype=np.uint8).reshape(7, 3)
    write_ply(tmp_path / "a.ply", points, colors)
    header, body = (tmp_path / "a.ply").read_bytes().split(b"end_header\n")
    assert b"binary_little_endian" in header
    assert b"element vertex 7" in header
    row = np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3)])
    back = np.frombuffer(body, row)
    assert np.array_equal(back["xyz"], points)
    assert np.array_equal(back["rgb"], colors)


def test_a_ply_needs_its_name_and_folder(tmp_path: Path) -> None:
    for bad in (tmp_path / "a.txt", tmp_path / "nowhere" / "a.ply"):
        with pytest.raises(DatabaseError, match=r"name a \.ply file"):
            write_ply(bad, np.zeros((1, 3), np.float32), np.zeros((1, 3), np.uint8))
