"""The local map: which points it takes in, which it keeps, and what adjustment may move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Array, Pose, inverse, transform
from slam.odometry.local_map import LocalMap
from slam.odometry.shutter import View
from slam.params import Params
from slam.types import Features
from tests.nodes import random_descriptors
from tests.scenes import CAMERA, nudged, random_pose

PLAIN = Params().changed({"OdomF2M/BundleAdjustment": False})
ADJUSTED = Params().changed({"OdomF2M/BundleAdjustment": True})
NONE = np.zeros(0, np.int32)
EXACT = np.zeros((6, 6))
quickly = settings(max_examples=15, deadline=None)


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
    local.add_keyframe(T_odom_base, EXACT, view, NONE, NONE, CAMERA, frame=1, params=PLAIN)
    assert len(local) == 50
    np.testing.assert_allclose(local.points_odom, points[30:], atol=1e-5)
    np.testing.assert_array_equal(local.descriptors, view.features.descriptors[30:])


def test_points_that_were_matched_are_not_taken_in_again() -> None:
    T_odom_base, points = np.eye(4), scene()
    local = LocalMap()
    local.add_keyframe(T_odom_base, EXACT, looking(T_odom_base, points[:60]), NONE, NONE, CAMERA, frame=1, params=PLAIN)
    local.add_keyframe(
        T_odom_base, EXACT, looking(T_odom_base, points), rows(60), rows(60), CAMERA, frame=2, params=PLAIN
    )
    np.testing.assert_allclose(local.points_odom, points, atol=1e-5)


def test_points_unseen_for_longest_leave_first() -> None:
    params, points = PLAIN.changed({"OdomF2M/MaxSize": 100}), scene(140)
    local, eye = LocalMap(), np.eye(4)
    local.add_keyframe(eye, EXACT, looking(eye, points[:100]), NONE, NONE, CAMERA, frame=1, params=params)
    view = looking(eye, points[:60], seed=9)
    local.seen(rows(60), view.features, rows(60), 2)
    np.testing.assert_array_equal(local.descriptors[:60], view.features.descriptors, "they take the newest look")
    local.add_keyframe(eye, EXACT, looking(eye, points[100:]), NONE, NONE, CAMERA, frame=3, params=params)
    assert len(local) == 100
    np.testing.assert_allclose(local.points_odom, points[[*range(60), *range(100, 140)]], atol=1e-5)


def noisy(view: View, rng: np.random.Generator, metres: float) -> View:
    """The view with depth that is a little wrong; along the ray, so that the pixel stays right."""
    points = view.features.points_base
    eye = CAMERA.T_base_cam[:3, 3]
    stretched = eye + (points - eye) * (1 + rng.normal(size=(len(points), 1)) * metres / 3.5)
    return replace(view, features=replace(view.features, points_base=stretched.astype(np.float32)))


def walk(
    params: Params, seed: int, *, frames: int = 8, off: float = 0.0, metres: float = 0.03, told: float = 0.0
) -> LocalMap:
    """A map of one scene after some key frames with noisy depth.

    All but the first are tracked ``off`` metres from the truth, and said to be ``told`` metres from it.
    """
    rng, points = np.random.default_rng(seed), scene(seed=seed)
    local = LocalMap()
    for frame in range(1, frames + 1):
        T_odom_base = random_pose(rng, 0.3, 0.1)
        view = noisy(looking(T_odom_base, points), rng, metres)
        seen = NONE if frame == 1 else rows(80)
        T_tracked = T_odom_base if frame == 1 else nudged(T_odom_base, rng, off, off / 4)
        covariance = EXACT if frame == 1 else np.diag([told**2] * 3 + [(told / 4) ** 2] * 3)
        local.add_keyframe(T_tracked, covariance, view, seen, seen, CAMERA, frame=frame, params=params)
    return local


def errors(local: LocalMap, seed: int) -> Array:
    return np.asarray(np.linalg.norm(local.points_odom - scene(seed=seed), axis=1))


@quickly
@given(st.integers(0, 10_000))
def test_adjusted_points_come_nearer_to_the_truth(seed: int) -> None:
    adjusted, plain = errors(walk(ADJUSTED, seed), seed), errors(walk(PLAIN, seed), seed)
    assert np.sqrt((adjusted**2).mean()) < 0.5 * np.sqrt((plain**2).mean())


@quickly
@given(st.integers(0, 10_000))
def test_a_good_map_is_not_made_worse(seed: int) -> None:
    assert errors(walk(ADJUSTED, seed, metres=0.0), seed).max() < 1e-4


@quickly
@given(st.integers(0, 10_000))
def test_poses_that_are_told_uncertain_move_points_less(seed: int) -> None:
    told, untold = (errors(walk(ADJUSTED, seed, off=0.003, metres=0.0, told=told), seed) for told in (0.003, 0.0))
    assert np.sqrt((told**2).mean()) < np.sqrt((untold**2).mean())


def test_without_adjustment_points_stay() -> None:
    first, last = walk(PLAIN, 0, frames=1), walk(PLAIN, 0)
    np.testing.assert_array_equal(first.points_odom, last.points_odom)


def test_adjustment_may_be_switched_on_later() -> None:
    points, eye, rng = scene(), np.eye(4), np.random.default_rng(3)
    local = LocalMap()
    local.add_keyframe(eye, EXACT, looking(eye, points), NONE, NONE, CAMERA, frame=1, params=PLAIN)
    before = local.points_odom.copy()
    view = noisy(looking(eye, points), rng, 0.03)
    local.add_keyframe(eye, EXACT, view, rows(80), rows(80), CAMERA, frame=2, params=ADJUSTED)
    np.testing.assert_array_equal(local.points_odom, before, "a first look weighs, but does not move")
    local.add_keyframe(eye, EXACT, view, rows(80), rows(80), CAMERA, frame=3, params=ADJUSTED)
    assert (local.points_odom != before).any()


def test_points_that_leave_take_what_was_known_of_them_along() -> None:
    params, points, eye = ADJUSTED.changed({"OdomF2M/MaxSize": 100}), scene(140), np.eye(4)
    local = LocalMap()
    local.add_keyframe(eye, EXACT, looking(eye, points[:100]), NONE, NONE, CAMERA, frame=1, params=params)
    view = looking(eye, points[60:])
    local.seen(rows(100)[60:], view.features, rows(40), 2)
    local.add_keyframe(eye, EXACT, view, rows(100)[60:], rows(40), CAMERA, frame=2, params=params)
    np.testing.assert_allclose(local.points_odom, points[[*range(20), *range(60, 140)]], atol=1e-4)
    again = looking(eye, local.points_odom)
    local.add_keyframe(eye, EXACT, again, rows(100), rows(100), CAMERA, frame=3, params=params)
    np.testing.assert_allclose(local.points_odom, points[[*range(20), *range(60, 140)]], atol=1e-4)
