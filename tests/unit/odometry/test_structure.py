"""Adjusting points with the poses held: one key frame at a time says what all together say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Array, Pose, inverse, transform
from slam.loop.bundle import adjust
from slam.odometry.structure import adjust_points
from tests.scenes import CAMERA, INTRINSICS, random_pose

quickly = settings(max_examples=15, deadline=None)
seeds = st.integers(0, 10_000)
COUNT = 60
ROWS = np.arange(COUNT)
FAR = 50


class Points:
    """Points as the local map holds them."""

    def __init__(self, points: Array) -> None:
        self.points = points.copy()
        self.information = np.zeros((len(points), 3, 3))
        self.looks = np.zeros(len(points), np.int64)

    def look(
        self,
        T_cam_ref: Pose,
        pixels: Array,
        inverse_depths: Array,
        rows: NDArray[np.int64] = ROWS,
        remembered: int = FAR,
    ) -> None:
        adjust_points(
            self.points,
            self.information,
            self.looks,
            rows,
            T_cam_ref,
            (0.0, 0.0),
            pixels,
            inverse_depths,
            INTRINSICS,
            remembered,
        )


def poses(rng: np.random.Generator, frames: int) -> Array:
    return np.array([inverse(random_pose(rng, 0.3, 0.1) @ CAMERA.T_base_cam) for _ in range(frames)])


def scene(rng: np.random.Generator) -> Array:
    return np.asarray(rng.uniform((2, -1.2, -0.9), (5, 1.2, 0.9), (COUNT, 3)))


def seen(T_cam_ref: Pose, points: Array, rng: np.random.Generator, noise: float) -> tuple[Array, Array]:
    """Pixels and inverse depths of the points, a quarter of them without depth; ``noise`` in sigmas."""
    in_cam = transform(T_cam_ref, points)
    inverse_depths = 1 / in_cam[:, 2] + rng.normal(size=COUNT) * noise * 0.008
    inverse_depths[: COUNT // 4] = np.nan
    return CAMERA.project(in_cam) + rng.normal(size=(COUNT, 2)) * noise, inverse_depths


@quickly
@given(seeds)
def test_one_at_a_time_says_what_all_together_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    true, T_cams = scene(rng), poses(rng, 5)
    looks = [seen(T, true, rng, 0.3) for T in T_cams]
    first = true + rng.normal(size=true.shape) * 0.003
    looks[0] = seen(T_cams[0], first, rng, 0.0)  # the first look is what put them there
    local = Points(first)
    for T, (pixels, inverse_depths) in zip(T_cams, looks, strict=True):
        local.look(T, pixels, inverse_depths)
    obs_point = np.repeat(ROWS, 5).astype(np.int32)
    obs_pose = np.tile(np.arange(5), COUNT).astype(np.int32)
    pixels, inverse_depths = (np.stack(column)[obs_pose, obs_point] for column in zip(*looks, strict=True))
    _, together, _, _, _ = adjust(T_cams, first, obs_pose, obs_point, pixels, inverse_depths, INTRINSICS, 5, 20)
    # Linearised around other places, they differ by less than either differs from the truth.
    apart = np.linalg.norm(local.points - together, axis=1)
    assert np.median(apart) < 0.3 * np.median(np.linalg.norm(together - true, axis=1))


@quickly
@given(seeds)
def test_the_truth_stays_and_information_grows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    true = scene(rng)
    local = Points(true)
    before = np.zeros(COUNT)
    for T in poses(rng, 6):
        local.look(T, *seen(T, true, rng, 0.0))
        least = np.linalg.eigvalsh(local.information)[:, 0]
        assert (least > before).all()
        before = least
    np.testing.assert_allclose(local.points, true, atol=1e-9)
    assert (local.looks == 6).all()


def test_the_first_look_does_not_move() -> None:
    rng = np.random.default_rng(0)
    true = scene(rng)
    T = poses(rng, 1)[0]
    local = Points(true + 0.02)
    local.look(T, *seen(T, true, rng, 0.0))
    np.testing.assert_array_equal(local.points, true + 0.02)


def test_a_wrong_look_does_not_pull() -> None:
    rng = np.random.default_rng(1)
    true, T_cams = scene(rng), poses(rng, 4)
    local = Points(true)
    for T in T_cams[:3]:
        local.look(T, *seen(T, true, rng, 0.0))
    pixels, inverse_depths = seen(T_cams[3], true, rng, 0.0)
    local.look(T_cams[3], pixels + 60.0, inverse_depths)
    np.testing.assert_allclose(local.points, true, atol=1e-9)
    assert (local.looks == 3).all()


@pytest.mark.parametrize("remembered", [2, 10])
def test_older_looks_fade(remembered: int) -> None:
    rng = np.random.default_rng(2)
    true, T = scene(rng), poses(rng, 1)[0]
    local = Points(true)
    for _ in range(4 * remembered):
        local.look(T, *seen(T, true, rng, 0.0), remembered=remembered)
    single = Points(true)
    single.look(T, *seen(T, true, rng, 0.0))
    assert (local.looks == remembered).all()
    np.testing.assert_allclose(local.information, remembered * single.information, rtol=1e-3, atol=1e-3)


def test_points_behind_the_camera_and_unseen_ones_stay() -> None:
    rng = np.random.default_rng(3)
    true, T = scene(rng), poses(rng, 1)[0]
    local = Points(true + 0.01)
    pixels, inverse_depths = seen(T, true, rng, 0.0)
    for _ in range(3):
        local.look(T, pixels[:20], inverse_depths[:20], rows=ROWS[:20])
    assert (local.points[:20] != true[:20] + 0.01).any()
    np.testing.assert_array_equal(local.points[20:], true[20:] + 0.01)
    before = local.points.copy()
    turned = T.copy()
    turned[2] *= -1
    local.look(turned, pixels, inverse_depths)
    np.testing.assert_array_equal(local.points, before)
