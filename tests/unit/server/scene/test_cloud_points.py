"""A cloud is even, small, without its ceiling and without what hangs in the air."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from server.scene.cloud_points import points_of_each, view_points
from slam.camera import Camera
from slam.errors import SlamError
from slam.geometry import transform
from tests.unit.server.scene.room_map import CAMERA, CEILING, FLOOR, HALF, seen, true_pose


def test_all_points_are_on_the_walls_and_the_floor_but_none_on_the_ceiling() -> None:
    image, depth = seen(2)
    cloud = view_points(image, depth, CAMERA, true_pose(2), 5000)
    points = transform(true_pose(2), cloud.points)
    on_wall = np.isclose(np.abs(points[:, :2]).max(axis=1), HALF, atol=0.02)
    on_floor = np.isclose(points[:, 2], FLOOR, atol=0.02)
    assert len(points) > 1000
    assert (on_wall | on_floor).all()
    assert points[:, 2].max() < 0.92 < CEILING


def test_a_view_of_the_ceiling_alone_is_kept() -> None:
    image, depth = seen(2)
    up = np.eye(4)
    up[:3, :3] = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    assert len(view_points(image, np.full_like(depth, 1.5), CAMERA, up, 5000).points) > 1000


def test_colours_belong_to_their_points() -> None:
    image, depth = seen(5)
    cloud = view_points(image, depth, CAMERA, true_pose(5), 5000)
    hit = transform(true_pose(5), cloud.points)
    low, high = np.array([-HALF, -HALF, FLOOR]), np.array([HALF, HALF, CEILING])
    expected = ((hit - low) / (high - low) * 255)[:, ::-1]
    assert np.abs(cloud.colours - expected).max() < 3


@pytest.mark.parametrize("most", [200, 1000])
def test_there_are_never_more_points_than_asked_for_and_they_keep_their_distance(most: int) -> None:
    image, depth = seen(3)
    cloud = view_points(image, depth, CAMERA, true_pose(3), most)
    assert 0.3 * most < len(cloud.points) <= most
    gaps = np.linalg.norm(cloud.points[:, None] - cloud.points[None], axis=2) + 9.0 * np.eye(len(cloud.points))
    assert np.median(gaps.min(axis=1)) > 0.4 * cloud.spacing


def test_points_between_a_near_thing_and_what_is_behind_it_are_left_out() -> None:
    camera = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
    image, depth = np.zeros((480, 640, 3), np.uint8), np.full((480, 640), 4.0, np.float32)
    depth[:, 320:] = 1.0
    depth[:, 318:320] = 2.5
    cloud = view_points(image, depth, camera, np.eye(4), 8000)
    assert not ((cloud.points[:, 0] > 1.1) & (cloud.points[:, 0] < 3.9)).any()
    assert len(cloud.points) > 4000


def test_no_depth_gives_no_points() -> None:
    image, depth = seen(1)
    assert len(view_points(image, np.zeros_like(depth), CAMERA, true_pose(1), 100).points) == 0


def test_the_fewer_clouds_the_more_points_has_each() -> None:
    numbers = [points_of_each(count) for count in (0, 1, 60, 100, 150)]
    assert numbers == sorted(numbers, reverse=True)
    assert 150 * numbers[-1] <= 1_000_000


@pytest.mark.parametrize("size", [(0, 0), (1, 1), (64, 48), (65535, 65535)])
@pytest.mark.parametrize("shape", [(1, 1), (24, 32), (100, 7), (300, 2)])
def test_sizes_that_do_not_fit_are_points_or_a_refusal(size: tuple[int, int], shape: tuple[int, int]) -> None:
    """Damaged files have images, depths and calibrations that know nothing of each other."""
    image, depth = np.zeros((48, 64, 3), np.uint8), np.ones(shape, np.float32)
    with suppress(SlamError):
        cloud = view_points(image, depth, Camera(*size, 50.0, 50.0, 31.5, 23.5), np.eye(4), 1000)
        assert np.isfinite(cloud.points).all()
