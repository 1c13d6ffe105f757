"""The rendered frames: repeatable, and consistent with their truth, depth and intrinsics."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from slam.geometry import inverse
from slam.sensors import open_source
from slam.sensors.tour.kinect import RANGE_M
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.scene import load_scene
from slam.sensors.tour.tour import Tour
from slam.types import Frame

from .views import agreement

TOUR = Tour(TourOptions())
SMALL = "tour:width=160,height=120,frames=4"


def same(a: Frame, b: Frame) -> bool:
    assert a.T_world_base is not None
    assert b.T_world_base is not None
    return (
        a.stamp == b.stamp
        and np.array_equal(a.image_bgr, b.image_bgr)
        and np.array_equal(a.depth_m, b.depth_m)
        and np.array_equal(a.T_world_base, b.T_world_base)
    )


def test_the_same_options_give_the_same_frames_bit_for_bit() -> None:
    first = list(open_source(SMALL))
    load_scene.cache_clear()
    again = list(open_source(SMALL))
    assert len(first) == 4
    assert all(same(a, b) for a, b in zip(first, again, strict=True))


def test_a_frame_does_not_depend_on_those_before() -> None:
    tour = Tour(TourOptions.parse("width=160,height=120"))
    alone = tour.render(3)
    assert same(alone, list(open_source(SMALL))[3])


def test_another_seed_is_another_walk_in_the_same_flat() -> None:
    a, b = (Tour(TourOptions(seed=seed, width=160, height=120)).render(0) for seed in (0, 1))
    assert not np.array_equal(a.image_bgr, b.image_bgr)
    assert agreement(a, b).grey < 8.0


@pytest.mark.parametrize("index", [0, 150, 300, 450, 590])
def test_frames_agree_by_truth_depth_and_intrinsics(index: int) -> None:
    a, b = TOUR.render(index), TOUR.render(index + 8)
    found = agreement(a, b)
    assert found.overlap > 0.4
    assert found.grey < 3.0
    assert found.depth < 0.012
    assert agreement(a, b, depth_scale=1.04).grey > 1.3 * found.grey
    assert agreement(replace(a, T_world_base=b.T_world_base), b).grey > 3 * found.grey
    off = replace(a.camera, cx=a.camera.cx + 4, cy=a.camera.cy - 4)
    assert agreement(replace(a, camera=off), b).grey > found.grey


def test_laps_see_the_same_places() -> None:
    lap = len(TOUR) // 2
    for index in (40, 220, 400):
        a = TOUR.render(index)
        best = min(
            (TOUR.render(index + lap + shift) for shift in range(-6, 7, 3)),
            key=lambda b: float(np.linalg.norm(b.T_world_base[:3, 3] - a.T_world_base[:3, 3])),
        )
        found = agreement(a, best)
        assert found.grey < 4.0
        assert found.overlap > 0.5
        assert not np.array_equal(a.image_bgr, best.image_bgr)


def test_pictures_have_many_corners_everywhere() -> None:
    counts = []
    for index in range(0, 620, 31):
        grey = cv2.cvtColor(TOUR.render(index).image_bgr, cv2.COLOR_BGR2GRAY)
        counts.append(len(cv2.goodFeaturesToTrack(grey, 1000, 0.001, 7)))
    assert min(counts) > 500


def test_depth_steps_and_noise_grow_with_the_square_of_distance() -> None:
    frame = TOUR.render(0)
    depth = frame.depth_m[frame.depth_m > 0]
    assert RANGE_M[0] <= depth.min()
    assert depth.max() <= RANGE_M[1]
    values = np.unique(depth)
    steps = np.diff(values) / values[1:] ** 2
    assert np.median(steps) == pytest.approx(1 / (8 * 580 * 0.075), rel=0.05)


def test_depth_is_unknown_in_the_projectors_shadow() -> None:
    depth = TOUR.render(0).depth_m
    holes = np.count_nonzero((depth == 0) & (cv2.blur((depth > 0).astype(np.float32), (31, 31)) > 0.5))
    assert 50 < holes < 0.05 * depth.size


def test_attitude_is_the_truth_without_its_yaw() -> None:
    frame = TOUR.render(123)
    assert frame.T_world_base is not None
    assert frame.T_gravity_base is not None
    yaw_only = frame.T_world_base[:3, :3] @ inverse(frame.T_gravity_base)[:3, :3]
    assert np.allclose(yaw_only[2], [0, 0, 1], atol=1e-12)


def test_stamps_follow_the_frame_rate() -> None:
    frames = [Tour(TourOptions.parse("fps=30,width=64,height=48")).render(index) for index in (0, 30)]
    assert frames[1].stamp - frames[0].stamp == pytest.approx(1.0)
    assert len(Tour(TourOptions(laps=1))) == pytest.approx(len(TOUR) / 2, abs=1)
    assert len(Tour(TourOptions(frames=10**5))) == len(TOUR)
