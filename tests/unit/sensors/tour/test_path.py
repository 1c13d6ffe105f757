"""The walk: smooth, at walking pace, clear of the furniture, and a little different each lap."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from slam.geometry import between, rotation_angle, to_euler_rpy
from slam.sensors.tour.options import TourOptions
from slam.sensors.tour.path import Walk
from slam.sensors.tour.rooms import furnish

STEP_S = 1 / 30


def walked(options: TourOptions) -> np.ndarray:
    walk = Walk(options)
    seconds = options.laps * walk.lap_m / options.speed
    return np.array([walk.T_world_base(t) for t in np.arange(0, seconds, STEP_S)])


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_it_is_walked_smoothly(seed: int) -> None:
    poses = walked(TourOptions(seed=seed))
    positions = poses[:, :3, 3]
    speed = np.linalg.norm(np.diff(positions, axis=0), axis=1) / STEP_S
    assert 0.65 < speed.min() < speed.max() < 0.95
    assert np.linalg.norm(np.diff(positions, 2, axis=0), axis=1).max() / STEP_S**2 < 1.0
    turn = [rotation_angle(between(a, b)) / STEP_S for a, b in pairwise(poses)]
    assert max(turn) < 0.65
    roll, pitch = np.degrees([to_euler_rpy(pose)[:2] for pose in poses]).T
    assert np.abs(roll).max() < 2.0
    assert np.abs(pitch).max() < 6.0
    assert np.allclose(positions[:, 2], 1.2, atol=0.04)


def test_a_lap_takes_about_forty_seconds() -> None:
    assert 35 < Walk(TourOptions()).lap_m / 0.8 < 45


def test_laps_lie_side_by_side() -> None:
    poses = walked(TourOptions(laps=2))
    half = len(poses) // 2
    first, second = poses[:half, :2, 3], poses[half : 2 * half, :2, 3]
    nearest = np.linalg.norm(first[::10, None] - second[None], axis=2).min(axis=1)
    assert np.quantile(nearest, 0.02) > 0.05
    assert nearest.max() < 0.15


@pytest.mark.parametrize("laps", [2, 20])
def test_nothing_stands_in_the_way(laps: int) -> None:
    positions = walked(TourOptions(laps=laps))[::10, None, :2, 3]
    low, high = (np.array([block[k][:2] for block in furnish().blocks]) for k in (0, 1))
    away = np.maximum(np.maximum(low - positions, positions - high), 0.0)
    assert np.linalg.norm(away, axis=2).min() > 0.4


def test_the_seed_decides() -> None:
    a, again, other = (Walk(TourOptions(seed=seed)).T_world_base(12.3) for seed in (5, 5, 6))
    assert np.array_equal(a, again)
    assert not np.allclose(a, other, atol=1e-4)
