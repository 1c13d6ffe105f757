"""The pose optimiser: exact without noise, within bounds with it, deaf to outliers, never worse than its start."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Array, Pose, between, make, rotation_angle, se3_exp, translation_norm
from slam.registration import pose
from slam.registration.pose import CHI2_DEPTH, CHI2_PIXEL, refine_pose
from tests.scenes import INTRINSICS, View, nudged, view

quickly = settings(max_examples=30, deadline=None)
seeds = st.integers(0, 10_000)


def apart(T_a: Pose, T_b: Pose) -> tuple[float, float]:
    """Metres and radians between two poses."""
    T_a_b = between(T_a, T_b)
    return translation_norm(T_a_b), rotation_angle(T_a_b)


def refined(seen: View, guess: Pose, rounds: int = 3) -> tuple[Pose, NDArray[np.bool_]]:
    return refine_pose(
        guess, seen.points_ref, seen.pixels.astype(np.float64), seen.inverse_depth, INTRINSICS, rounds=rounds
    )


def cost(seen: View, T_cam_ref: Pose) -> float:
    """Cauchy cost of all points, written out once more."""
    points = seen.points_ref @ T_cam_ref[:3, :3].T + T_cam_ref[:3, 3]
    uv = points[:, :2] / points[:, 2:] * INTRINSICS[:2] + INTRINSICS[2:]
    chi2 = ((seen.pixels - uv) ** 2).sum(axis=1) / pose.SIGMA_PX**2
    depth = (seen.inverse_depth - 1 / points[:, 2]) / pose.SIGMA_INVERSE_DEPTH
    limit = np.where(np.isnan(depth), CHI2_PIXEL, CHI2_DEPTH)
    chi2 = np.where(points[:, 2] <= 0.05, 1e4, chi2 + np.nan_to_num(depth) ** 2)
    return float((limit * np.log1p(chi2 / limit)).sum())


@quickly
@given(seeds, st.sampled_from([0.0, 0.5, 1.0]))
def test_a_known_pose_is_found_exactly_without_noise(seed: int, with_depth: float) -> None:
    seen = view(seed, with_depth=with_depth)
    guess = nudged(seen.T_cam_ref, np.random.default_rng(seed), 0.05, 0.03)
    T_cam_ref, inliers = refined(seen, guess)
    metres, radians = apart(seen.T_cam_ref, T_cam_ref)
    assert inliers.all()
    assert metres < 1e-5  # pixels are float32
    assert radians < 1e-5


@quickly
@given(seeds)
def test_noise_and_two_outliers_in_five_leave_the_pose_within_a_centimetre(seed: int) -> None:
    seen = view(seed, 200, pixel_noise=0.7, depth_noise=0.7, outliers=0.4)
    guess = nudged(seen.T_cam_ref, np.random.default_rng(seed), 0.02, 0.01)
    T_cam_ref, inliers = refined(seen, guess)
    metres, radians = apart(seen.T_cam_ref, T_cam_ref)
    assert metres < 0.01
    assert radians < 0.005
    assert inliers[~seen.outlier].mean() > 0.9
    assert inliers[seen.outlier].mean() < 0.05


@quickly
@given(seeds, st.floats(0, 1.5), st.floats(0, 1.5), st.floats(0, 0.8))
def test_one_descent_never_worsens_the_cost(seed: int, metres: float, radians: float, outliers: float) -> None:
    seen = view(seed, 60, pixel_noise=1.0, depth_noise=1.0, outliers=outliers)
    guess = nudged(seen.T_cam_ref, np.random.default_rng(seed), metres, radians)
    T_cam_ref, _ = refined(seen, guess, rounds=1)
    assert cost(seen, T_cam_ref) <= cost(seen, guess) * (1 + 1e-9)


@quickly
@given(seeds, st.floats(0, 2.0), st.floats(0, 3.0))
def test_rotations_stay_orthonormal(seed: int, metres: float, radians: float) -> None:
    seen = view(seed, 30, outliers=0.5)
    guess = nudged(seen.T_cam_ref, np.random.default_rng(seed), metres, radians)
    T_cam_ref, _ = refined(seen, guess)
    R = T_cam_ref[:3, :3]
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-12
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert T_cam_ref[3].tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize("with_depth", [0.0, 1.0])
@pytest.mark.parametrize(("share", "inlier"), [(0.95, True), (1.1, False)])
def test_inliers_are_the_points_within_the_quantile(with_depth: float, share: float, inlier: bool) -> None:
    seen = view(1, 300, with_depth=with_depth)
    pixels = seen.pixels.astype(np.float64)
    pixels[0, 0] += share * np.sqrt(CHI2_DEPTH if with_depth else CHI2_PIXEL)
    _, inliers = refine_pose(seen.T_cam_ref, seen.points_ref, pixels, seen.inverse_depth, INTRINSICS)
    assert inliers.tolist() == [inlier, *[True] * 299]


def test_wrong_depth_makes_an_outlier_of_a_right_pixel() -> None:
    seen = view(2, 40, with_depth=1.0)
    depth = seen.inverse_depth.copy()
    depth[0] += 3.5 * pose.SIGMA_INVERSE_DEPTH
    _, inliers = refine_pose(seen.T_cam_ref, seen.points_ref, seen.pixels.astype(np.float64), depth, INTRINSICS)
    assert inliers.tolist() == [False, *[True] * 39]


def test_points_behind_the_camera_are_no_inliers_and_pull_nothing() -> None:
    seen = view(3, 60)
    turned = np.asarray(make(np.diag([-1.0, 1.0, -1.0]), np.zeros(3)) @ seen.T_cam_ref)
    T_cam_ref, inliers = refined(seen, turned)
    assert np.isfinite(T_cam_ref).all()
    assert not inliers.any()


def test_depth_tells_how_far_where_pixels_hardly_do() -> None:
    errors = {"with": 0.0, "without": 0.0}
    for seed in range(10):
        seen = view(seed, 600, pixel_noise=1.0, depth_noise=0.3, with_depth=1.0)
        few = np.abs(seen.pixels - INTRINSICS[2:]).max(axis=1) < 60
        for name, depth in (("with", seen.inverse_depth), ("without", np.full(600, np.nan))):
            pixels = seen.pixels[few].astype(np.float64)
            T, _ = refine_pose(seen.T_cam_ref, seen.points_ref[few], pixels, depth[few], INTRINSICS)
            errors[name] += apart(seen.T_cam_ref, T)[0]
    assert errors["with"] < 0.8 * errors["without"]


@quickly
@given(st.lists(st.floats(-2, 2), min_size=6, max_size=6), seeds)
def test_tangents_act_from_the_left_like_the_exponential(tangent: list[float], seed: int) -> None:
    T = se3_exp(np.random.default_rng(seed).normal(size=6))
    R, t = T[:3, :3].copy(), T[:3, 3].copy()
    pose.apply_tangent(R, t, np.array(tangent))
    expected = se3_exp(np.array(tangent)) @ T
    np.testing.assert_allclose(R, expected[:3, :3], atol=1e-9)
    np.testing.assert_allclose(t, expected[:3, 3], atol=1e-9)


@quickly
@given(seeds, st.booleans())
def test_the_jacobian_is_the_derivative(seed: int, has_depth: bool) -> None:
    rng = np.random.default_rng(seed)
    R, t = np.eye(3), np.zeros(3)
    point = rng.uniform((-1, -1, 1), (1, 1, 5))
    w = 0.4 if has_depth else np.nan
    J, G, r, p = np.zeros((3, 3)), np.zeros((3, 6)), np.zeros(3), np.zeros(3)

    def at(tangent: Array) -> Array:
        """The residual after a small motion."""
        moved_R, moved_t, out = R.copy(), t.copy(), np.zeros(3)
        pose.apply_tangent(moved_R, moved_t, tangent)
        pose.residual(moved_R, moved_t, point, 300.0, 200.0, w, INTRINSICS, out, np.zeros(3))
        return out

    pose.residual(R, t, point, 300.0, 200.0, w, INTRINSICS, r, p)
    pose.jacobian(p, has_depth, INTRINSICS, J)
    pose.pose_jacobian(J, p, G)
    numeric = [(at(h) - at(-h)) / 2e-6 for h in 1e-6 * np.eye(6)]
    np.testing.assert_allclose(-G.T, numeric, rtol=1e-4, atol=1e-3)  # the residual is measured - predicted
