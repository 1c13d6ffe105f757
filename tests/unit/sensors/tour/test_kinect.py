"""The depth camera's limits, on a made-up scene: a post in front of a wall."""

from __future__ import annotations

import numpy as np
import pytest

from slam.sensors.tour.kinect import BASELINE_M, FOCAL_BASELINE, RANGE_M, STEPS_PER_PIXEL, measure

FOCAL_PX, WALL_M, POST_M = 525.0, 4.0, 1.0
SILENT = np.zeros(1024, np.float32)


def measured(z: np.ndarray, noise: np.ndarray = SILENT, start: int = 0) -> np.ndarray:
    depth = np.empty(z.shape, np.float32)
    measure(1.0 / z, noise, start, FOCAL_PX, depth)
    return depth


def test_a_post_throws_a_shadow_to_its_left() -> None:
    z = np.full((3, 200), WALL_M)
    z[:, 100:120] = POST_M
    depth = measured(z)
    shadow = np.flatnonzero(depth[1] == 0)
    width = FOCAL_PX * BASELINE_M * (1 / POST_M - 1 / WALL_M)
    assert shadow.max() == 99
    assert len(shadow) == pytest.approx(width, abs=2)
    assert np.array_equal(shadow, np.arange(shadow.min(), 100))
    assert depth[0, 110] == pytest.approx(POST_M, abs=0.003)


def test_a_slanted_wall_has_no_shadow() -> None:
    assert np.all(measured(np.tile(np.linspace(2, 5, 300), (2, 1))) > 0)
    assert np.all(measured(np.tile(np.linspace(5, 2, 300), (2, 1))) > 0)


@pytest.mark.parametrize("z", [0.5, 1.0, 2.0, 4.0, 7.0])
def test_depth_comes_in_steps_of_disparity(z: float) -> None:
    found = measured(np.full((1, 4), z))[0, 0]
    steps = FOCAL_BASELINE * STEPS_PER_PIXEL / found
    assert steps == pytest.approx(round(float(steps)), abs=1e-3)
    assert abs(found - z) <= 0.51 * z**2 / (FOCAL_BASELINE * STEPS_PER_PIXEL)


def test_noise_grows_with_the_square_of_distance() -> None:
    noise = np.random.default_rng(0).standard_normal(1 << 16).astype(np.float32)
    spread = [float(np.std(measured(np.full((200, 200), z), noise))) for z in (1.5, 3.0, 6.0)]
    assert spread[1] / spread[0] == pytest.approx(4.0, rel=0.1)
    assert spread[2] / spread[1] == pytest.approx(4.0, rel=0.1)
    assert spread[0] == pytest.approx(1.43e-3 * 1.5**2, rel=0.25)


def test_nothing_is_measured_outside_the_range() -> None:
    z = np.array([[0.2, RANGE_M[0] - 0.01, RANGE_M[1] + 0.1, 30.0, 1e9]])
    assert np.all(measured(z) == 0)
