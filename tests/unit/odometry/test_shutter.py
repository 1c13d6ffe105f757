"""A rolling shutter's pictures are straightened, late depth is brought forward, and the readout time is found."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import Array, inverse, se3_exp, transform
from slam.odometry.shutter import Readout, View, pixel_jacobian, straighten
from slam.params import Params
from slam.types import Features, Frame
from tests.nodes import random_descriptors
from tests.scenes import CAMERA

PARAMS = Params()
HEIGHT, WIDTH = CAMERA.height, CAMERA.width
WALL_M = 2.5


def frame(*, delay_s: float = 0.0, depth_m: float = WALL_M) -> Frame:
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    return Frame(0, 0.0, image, np.full((HEIGHT, WIDTH), depth_m, np.float32), CAMERA, depth_delay_s=delay_s)


def features(pixels: Array, depth: Array) -> Features:
    count = len(pixels)
    ones = np.ones(count, np.float32)
    points = transform(CAMERA.T_base_cam, CAMERA.unproject(pixels, depth)).astype(np.float32)
    return Features(
        pixels.astype(np.float32), ones, ones, ones, np.zeros(count, np.int32), random_descriptors(count, 0), points
    )


def wall_points(seed: int, count: int = 200) -> Array:
    """Points (N, 3) in the camera frame, all over the image, 1.5 to 4 m away."""
    rng = np.random.default_rng(seed)
    pixels = rng.uniform((0.15 * WIDTH, 0.15 * HEIGHT), (0.85 * WIDTH, 0.85 * HEIGHT), (count, 2))
    return CAMERA.unproject(pixels, rng.uniform(1.5, 4.0, count))


def rolled(points_cam: Array, twist: Array, readout_s: float) -> Array:
    """Where a rolling shutter sees points of a scene while it moves; rows solve for their own moment."""
    pixels = CAMERA.project(points_cam)
    for _ in range(3):
        moments = (pixels[:, 1] / HEIGHT - 0.5) * readout_s
        seen = [transform(inverse(se3_exp(twist * t)), p[None])[0] for t, p in zip(moments, points_cam, strict=True)]
        pixels = CAMERA.project(np.array(seen))
    return pixels


twists = st.tuples(*[st.floats(-0.5, 0.5)] * 3, *[st.floats(-1.0, 1.0)] * 3).map(np.array)


@settings(max_examples=25)
@given(twists, st.floats(0.0, 0.03))
def test_a_rolled_picture_is_straightened(twist: Array, readout_s: float) -> None:
    points = wall_points(1, 60)
    whole, seen = CAMERA.project(points), rolled(points, twist, readout_s)
    view = straighten(features(seen, points[:, 2]), frame(), twist, readout_s, PARAMS)
    before, after = np.abs(seen - whole).max(), np.abs(view.features.pixels - whole).max()
    assert after <= 0.05 * before + 0.02, "what is left is of second order"


def test_a_camera_that_stands_or_has_a_global_shutter_sees_what_is_there() -> None:
    points = wall_points(2)
    seen = features(CAMERA.project(points), points[:, 2])
    assert straighten(seen, frame(), np.zeros(6), 0.03, PARAMS).features is seen
    moving = straighten(seen, frame(), np.full(6, 0.4), 0.0, PARAMS).features
    np.testing.assert_allclose(moving.pixels, seen.pixels, atol=1e-3)
    np.testing.assert_allclose(moving.points_base, seen.points_base, atol=1e-4)


@pytest.mark.parametrize("delay_s", [-0.015, 0.012])
def test_depth_of_another_moment_is_brought_to_the_stamp(delay_s: float) -> None:
    """A camera that drives at a wall at 0.8 m/s: the depth image knows the wall as it was ``delay_s`` later."""
    speed = 0.8
    pixels = CAMERA.project(wall_points(3))
    seen = features(pixels, np.full(len(pixels), WALL_M - speed * delay_s))
    late = frame(delay_s=delay_s, depth_m=WALL_M - speed * delay_s)
    view = straighten(seen, late, np.array([0, 0, speed, 0, 0, 0]), 0.0, PARAMS)
    depth = transform(inverse(CAMERA.T_base_cam), view.features.points_base)[:, 2]
    np.testing.assert_allclose(depth, WALL_M, atol=1e-3)


def test_slopes_are_what_a_little_more_readout_does() -> None:
    points, twist = wall_points(4), np.array([0.3, -0.2, 0.1, 0.5, -0.4, 0.6])
    seen = features(CAMERA.project(points), points[:, 2])
    one, more = (straighten(seen, frame(), twist, s, PARAMS) for s in (0.010, 0.020))
    change = more.features.points_base - one.features.points_base
    np.testing.assert_allclose(change / 0.010, one.slopes_base, atol=2e-3)


def test_slopes_follow_a_pose_that_depends_on_the_readout() -> None:
    points, tangent = wall_points(5), np.array([0.1, 0.2, -0.1, 0.05, -0.02, 0.3])
    view = View.still(features(CAMERA.project(points), points[:, 2])).following(tangent, CAMERA)
    # The camera's points move by the tangent, so that the same points lie the other way round in the map.
    moved = transform(CAMERA.T_base_cam @ inverse(se3_exp(tangent * 1e-4)), points) - transform(
        CAMERA.T_base_cam, points
    )
    np.testing.assert_allclose(view.slopes_base, moved / 1e-4, atol=1e-3)


@settings(max_examples=25)
@given(st.integers(0, 1000))
def test_the_pixel_jacobian_is_the_derivative(seed: int) -> None:
    points = wall_points(seed, 5)
    J = pixel_jacobian(points, CAMERA)
    for k in range(6):
        step = np.zeros(6)
        step[k] = 1e-6
        moved = (CAMERA.project(transform(se3_exp(step), points)) - CAMERA.project(points)) / 1e-6
        np.testing.assert_allclose(J[:, :, k], moved, rtol=1e-3, atol=1e-2)


def learned(readout_s: float, frames: int, noise_px: float = 0.5) -> tuple[Readout, Params]:
    """What is learned by a camera that swings to and fro before points whose place is known."""
    rng, readout = np.random.default_rng(7), Readout()
    for k in range(frames):
        points = wall_points(k, 60)
        twist = np.array([0.3, 0.2, 0.1, 0.6, 0.5, 0.4]) * np.sin(0.7 * k + np.arange(6))
        seen = rolled(points, twist, readout_s) + rng.normal(0, noise_px, (len(points), 2))
        view = straighten(features(seen, points[:, 2]), frame(), twist, readout.seconds(PARAMS), PARAMS)
        missed = view.features.pixels - CAMERA.project(points)
        readout.learn(missed, view.rates, pixel_jacobian(points, CAMERA))
    return readout, PARAMS


@pytest.mark.parametrize("readout_s", [0.010, 0.025])
def test_the_readout_is_found(readout_s: float) -> None:
    readout, params = learned(readout_s, 60)
    assert readout.seconds(params) == pytest.approx(readout_s, abs=0.002)
    assert readout.seconds(params.changed({"Odom/ReadoutTime": 5.0})) == 0.005, "what is given counts"


def test_a_global_shutter_is_left_alone() -> None:
    readout, params = learned(0.0, 60)
    assert readout.seconds(params) == 0.0


def test_a_camera_that_stands_learns_nothing() -> None:
    readout, points = Readout(), wall_points(1)
    J = pixel_jacobian(points, CAMERA)
    missed = np.random.default_rng(0).normal(0, 1, (len(points), 2))
    for _ in range(50):
        change, follows = readout.learn(missed, np.zeros((len(points), 2)), J)
        assert change == 0.0 and not follows.any()
    assert readout.seconds(PARAMS) == 0.0
