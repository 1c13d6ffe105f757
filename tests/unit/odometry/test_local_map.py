"""The local map: which points it takes in, which it keeps, and what adjustment may move."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.geometry import Array, Pose, between, inverse, rotation_angle, transform, translation_norm
from slam.odometry.local_map import LocalMap
from slam.odometry.shutter import View
from slam.params import Params
from slam.types import Features
from tests.nodes import random_descriptors
from tests.scenes import CAMERA, nudged, random_pose

PLAIN = Params().changed({"OdomF2M/BundleAdjustment": False})
ADJUSTED = Params().changed({"OdomF2M/BundleAdjustment": True})
NONE = np.zeros(0, np.int32)


def looking(T_odom_base: Pose, points_odom: Array, seed: int = 0, *, hidden: int = 0) -> View:
    """A view of points; of the first ``hidden`` it knows no depth. Row i shows point i."""
    pixels = CAMERA.project(transform(inverse(T_odom_base @ CAMERA.T_base_cam), points_odom))
    points_base = transform(inverse(T_odom_base), points_odom).astype(np.float32)
    points_base[:hidden] = np.nan
    count = len(points_odom)
    ones = np.ones(count, np.float32)
    descriptors = random_descriptors(count, seed)
    octaves = np.zeros(count, np.int32)
    return View.still(Features(pixels.astype(np.float32), ones, ones, ones, octaves, descriptors, points_base))


def scene(count: int = 80, seed: int = 0) -> Array:
    return np.random.default_rng(seed).uniform((2, -1.2, -0.9), (5, 1.2, 0.9), (count, 3))


def rows(count: int) -> NDArray[np.int32]:
    return np.arange(count, dtype=np.int32)


def test_points_with_depth_are_taken_in_where_the_pose_puts_them() -> None:
    T_odom_base, points = random_pose(np.random.default_rng(1)), scene()
    view = looking(T_odom_base, points, hidden=30)
    local = LocalMap()
    local.add_keyframe(T_odom_base, view, NONE, NONE, CAMERA, frame=1, params=PLAIN)
    assert len(local) == 50
    np.testing.assert_allclose(local.points_odom, points[30:], atol=1e-5)
    np.testing.assert_array_equal(local.descriptors, view.features.descriptors[30:])


def test_points_that_were_matched_are_not_taken_in_again() -> None:
    T_odom_base, points = np.eye(4), scene()
    local = LocalMap()
    local.add_keyframe(T_odom_base, looking(T_odom_base, points[:60]), NONE, NONE, CAMERA, frame=1, params=PLAIN)
    local.add_keyframe(T_odom_base, looking(T_odom_base, points), rows(60), rows(60), CAMERA, frame=2, params=PLAIN)
    np.testing.assert_allclose(local.points_odom, points, atol=1e-5)


def test_points_unseen_for_longest_leave_first() -> None:
    params, points = PLAIN.changed({"OdomF2M/MaxSize": 100}), scene(140)
    local, eye = LocalMap(), np.eye(4)
    local.add_keyframe(eye, looking(eye, points[:100]), NONE, NONE, CAMERA, frame=1, params=params)
    view = looking(eye, points[:60], seed=9)
    local.seen(rows(60), view.features, rows(60), 2)
    np.testing.assert_array_equal(local.descriptors[:60], view.features.descriptors, "they take the newest look")
    local.add_keyframe(eye, looking(eye, points[100:]), NONE, NONE, CAMERA, frame=3, params=params)
    assert len(local) == 100
    np.testing.assert_allclose(local.points_odom, points[[*range(60), *range(100, 140)]], atol=1e-5)


def shaken_walk(params: Params, seed: int = 0) -> tuple[LocalMap, list[Pose], list[Pose]]:
    """Three key frames of one scene, of which the later ones are tracked 3 cm off; true poses and those returned."""
    rng, points = np.random.default_rng(seed), scene()
    local, true, found = LocalMap(), [np.eye(4)], []
    found.append(local.add_keyframe(true[0], looking(true[0], points), NONE, NONE, CAMERA, frame=1, params=params))
    for frame in (2, 3):
        true.append(random_pose(rng, 0.3, 0.1))
        tracked = nudged(true[-1], rng, 0.03, 0.005)
        view = looking(true[-1], points)
        found.append(local.add_keyframe(tracked, view, rows(80), rows(80), CAMERA, frame=frame, params=params))
    return local, true, found


def test_adjustment_moves_a_pose_that_was_off_to_where_the_points_say() -> None:
    local, true, found = shaken_walk(ADJUSTED)
    for T_true, T_found in zip(true, found, strict=True):
        assert translation_norm(between(T_true, T_found)) < 0.005
        assert rotation_angle(between(T_true, T_found)) < 0.002
    assert np.linalg.norm(local.points_odom - scene(), axis=1).max() < 0.02


def test_without_adjustment_poses_and_points_stay() -> None:
    local, true, found = shaken_walk(PLAIN)
    assert all(translation_norm(between(a, b)) > 0.01 for a, b in zip(true[1:], found[1:], strict=True))
    np.testing.assert_allclose(local.points_odom, scene(), atol=1e-5)


@pytest.mark.parametrize("frames", [1, 2, 5])
def test_no_more_key_frames_are_kept_than_take_part_or_hold_the_others(frames: int) -> None:
    params, points = ADJUSTED.changed({"OdomF2M/BundleAdjustmentMaxFrames": max(2, frames)}), scene()
    local, eye = LocalMap(), np.eye(4)
    for frame in range(1, 20):
        seen = NONE if frame == 1 else rows(80)
        local.add_keyframe(eye, looking(eye, points), seen, seen, CAMERA, frame=frame, params=params)
    assert len(local._keyframes) == min(19, 3 * max(2, frames)), "the older ones hold, the newest move"
    np.testing.assert_allclose(local.points_odom, points, atol=1e-4)
