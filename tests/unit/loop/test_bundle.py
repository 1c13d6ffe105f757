"""Bundle adjustment: lowers the cost, finds a scene again that was shaken, and holds what it must hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Array, Pose, between, inverse, rotation_angle, translation_norm
from slam.loop.bundle import adjust, total_cost
from tests.scenes import CAMERA, INTRINSICS, nudged, random_pose

quickly = settings(max_examples=15, deadline=None)
seeds = st.integers(0, 10_000)


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """Key frames that see one scene: true poses (K, 4, 4) and points (P, 3), observations as ``adjust`` takes them."""

    poses: Array
    points: Array
    obs_pose: NDArray[np.int32]
    obs_point: NDArray[np.int32]
    pixels: Array
    inverse_depth: Array

    def adjusted(
        self, poses: Array, points: Array, *, fixed: int = 1, iterations: int = 30
    ) -> tuple[Array, Array, NDArray[np.bool_], float, float]:
        return adjust(
            poses, points, self.obs_pose, self.obs_point, self.pixels, self.inverse_depth, INTRINSICS, fixed, iterations
        )

    def cost(self, poses: Array, points: Array) -> float:
        return total_cost(poses, points, self.obs_pose, self.obs_point, self.pixels, self.inverse_depth, INTRINSICS)

    def shaken(self, seed: int, metres: float = 0.03, radians: float = 0.01) -> tuple[Array, Array]:
        """Poses, but for the first, and points a little off."""
        rng = np.random.default_rng(seed)
        poses = [self.poses[0], *(nudged(T, rng, metres, radians) for T in self.poses[1:])]
        return np.array(poses), self.points + rng.normal(size=self.points.shape) * metres


def shot(seed: int, frames: int = 4, count: int = 60, *, noise: float = 0.0, outliers: float = 0.0) -> Shot:
    """A scene before a few key frames, each of which sees most of it, and the depth of most of that."""
    rng = np.random.default_rng(seed)
    points = rng.uniform((2, -1.2, -0.9), (5, 1.2, 0.9), (count, 3))
    T_ref_base = [random_pose(rng, 0.3, 0.1) for _ in range(frames)]
    poses = np.array([inverse(T @ CAMERA.T_base_cam) for T in T_ref_base])
    seen = np.argwhere(rng.random((count, frames)) < 0.9)
    obs_point, obs_pose = seen.T.astype(np.int32)
    in_cam = np.einsum("nij,nj->ni", poses[obs_pose, :3, :3], points[obs_point]) + poses[obs_pose, :3, 3]
    pixels = CAMERA.project(in_cam) + rng.normal(size=(len(seen), 2)) * noise
    wrong = rng.random(len(seen)) < outliers
    pixels[wrong] += rng.uniform(30, 80, (int(wrong.sum()), 2))
    inverse_depth = np.where(rng.random(len(seen)) < 0.7, 1 / in_cam[:, 2], np.nan)
    inverse_depth += rng.normal(size=len(seen)) * noise * 0.004
    return Shot(poses, points, obs_pose.copy(), obs_point.copy(), pixels, inverse_depth)


def worst(a: Array, b: Array) -> tuple[float, float]:
    """Largest distance in metres and radians of poses (K, 4, 4)."""
    apart = [between(x, y) for x, y in zip(a, b, strict=True)]
    return max(map(translation_norm, apart)), max(map(rotation_angle, apart))


@quickly
@given(seeds, st.floats(0, 2), st.floats(0, 0.3))
def test_the_cost_never_rises_and_is_told_truly(seed: int, noise: float, outliers: float) -> None:
    scene = shot(seed, noise=noise, outliers=outliers)
    start = scene.shaken(seed)
    poses, points, _, before, after = scene.adjusted(*start, iterations=4)
    assert before == pytest.approx(scene.cost(*start))
    assert after == pytest.approx(scene.cost(poses, points))
    assert after <= before


@quickly
@given(seeds)
def test_a_shaken_scene_is_found_again(seed: int) -> None:
    scene = shot(seed)
    poses, points, inliers, _, after = scene.adjusted(*scene.shaken(seed), iterations=60)
    metres, radians = worst(scene.poses, poses)
    assert metres < 2e-3
    assert radians < 1e-3
    assert np.median(np.linalg.norm(points - scene.points, axis=1)) < 2e-3
    assert inliers.mean() > 0.99
    assert after < 1.0


@quickly
@given(seeds)
def test_noise_and_outliers_leave_poses_within_centimetres(seed: int) -> None:
    scene = shot(seed, 5, 120, noise=0.7, outliers=0.1)
    poses, _, inliers, _, _ = scene.adjusted(*scene.shaken(seed))
    metres, radians = worst(scene.poses, poses)
    assert metres < 0.045, "half as much again as the worst of 150 scenes"
    assert radians < 0.013
    assert 0.75 < inliers.mean() < 0.93


@pytest.mark.parametrize("fixed", [1, 2, 4])
def test_fixed_poses_are_held_to_the_bit(fixed: int) -> None:
    scene = shot(1)
    start, points = scene.shaken(1)
    poses, moved, _, before, after = scene.adjusted(start, points, fixed=fixed)
    np.testing.assert_array_equal(poses[:fixed], start[:fixed])
    assert all((poses[k] != start[k]).any() for k in range(fixed, 4))
    assert (moved != points).any()
    assert after < before


def test_the_input_is_not_changed() -> None:
    scene = shot(2)
    poses, points = scene.shaken(2)
    copies = poses.copy(), points.copy()
    scene.adjusted(poses, points)
    np.testing.assert_array_equal(poses, copies[0])
    np.testing.assert_array_equal(points, copies[1])


def test_rotations_stay_orthonormal() -> None:
    scene = shot(3, noise=1.0, outliers=0.3)
    poses, _, _, _, _ = scene.adjusted(*scene.shaken(3, 0.1, 0.05))
    R = poses[:, :3, :3]
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.broadcast_to(np.eye(3), R.shape), atol=1e-9)


def test_at_the_minimum_nothing_moves() -> None:
    scene = shot(4)
    poses, points, inliers, before, after = scene.adjusted(scene.poses, scene.points)
    assert before == pytest.approx(0, abs=1e-9)
    assert after <= before
    np.testing.assert_allclose(poses, scene.poses, atol=1e-6)
    np.testing.assert_allclose(points, scene.points, atol=1e-6)
    assert inliers.all()


def test_a_point_that_nobody_sees_stays() -> None:
    scene = shot(5)
    start, points = scene.shaken(5)
    lonely = np.concatenate([points, [[9.0, 9.0, 9.0]]])
    _, moved, _, _, _ = scene.adjusted(start, lonely)
    assert moved[-1].tolist() == [9.0, 9.0, 9.0]


def test_an_observation_behind_the_camera_costs_as_a_far_outlier_does() -> None:
    scene = shot(6, 1, 10)
    turned: Pose = scene.poses[0].copy()
    turned[2] *= -1
    turned[0] *= -1
    cost = scene.cost(turned[None], scene.points)
    assert np.isfinite(cost)
    assert cost > 100 * len(scene.obs_pose)
