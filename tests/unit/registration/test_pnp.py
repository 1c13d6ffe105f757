"""Pose from points and pixels, with a good, a hopeless or no guess; and what its covariance says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Pose, between, inverse, make, rotation_angle, transform, translation_norm
from slam.params import Params
from slam.registration import pnp
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.types import UNKNOWN_VARIANCE
from tests.scenes import CAMERA, View, nudged, random_pose, view

PARAMS = Params()
quickly = settings(max_examples=20, deadline=None)
seeds = st.integers(0, 10_000)


def solved(seen: View, guess: Pose | None) -> tuple[Pose, NDArray[np.bool_]]:
    return solve_pnp(seen.points_ref, seen.pixels, seen.points_base, CAMERA, PARAMS, T_ref_base=guess)


def error(seen: View, T_ref_base: Pose) -> tuple[float, float]:
    """Metres and radians from the truth."""
    T = between(seen.T_ref_base, T_ref_base)
    return translation_norm(T), rotation_angle(T)


@quickly
@given(seeds, st.sampled_from(["none", "near", "hopeless"]))
def test_the_pose_is_found_whatever_the_guess(seed: int, kind: str) -> None:
    seen, rng = view(seed, 150, pixel_noise=0.5, depth_noise=0.5, outliers=0.3), np.random.default_rng(seed)
    turned = np.asarray(seen.T_ref_base @ make(np.diag([-1.0, -1.0, 1.0]), np.array([5.0, -3.0, 1.0])))
    guess = {"none": None, "near": nudged(seen.T_ref_base, rng, 0.02, 0.01), "hopeless": turned}[kind]
    T_ref_base, inliers = solved(seen, guess)
    metres, radians = error(seen, T_ref_base)
    assert metres < 0.02
    assert radians < 0.01
    assert inliers[~seen.outlier].mean() > 0.9
    assert inliers[seen.outlier].mean() < 0.1


def test_a_guess_that_suffices_spares_the_random_search(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(pnp, "_ransac", lambda *_: asked.append(1))
    good, poor = view(1, 100, outliers=0.3), view(1, 100, outliers=0.7)
    assert solved(good, good.T_ref_base)[1].sum() >= 70
    assert not asked
    solved(poor, poor.T_ref_base)
    assert asked


def test_without_any_agreement_there_is_no_inlier() -> None:
    seen = view(1, 40, outliers=1.0)
    T_ref_base, inliers = solved(seen, None)
    assert inliers.sum() < PARAMS.Vis.MinInliers
    assert np.isfinite(T_ref_base).all()


@quickly
@given(seeds)
def test_another_reference_frame_moves_the_pose_along(seed: int) -> None:
    seen, T_new_ref = view(seed, 80, pixel_noise=0.3), random_pose(np.random.default_rng(seed), 10.0, 3.0)
    moved = solve_pnp(
        transform(T_new_ref, seen.points_ref), seen.pixels, seen.points_base, CAMERA, PARAMS, T_ref_base=None
    )
    plain = solved(seen, None)
    np.testing.assert_allclose(moved[0], T_new_ref @ plain[0], atol=1e-3)
    R = moved[0][:3, :3]
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9


def test_the_same_input_gives_the_same_pose_bit_for_bit() -> None:
    seen = view(5, 100, pixel_noise=1.0, outliers=0.4)
    first, second = solved(seen, None), solved(seen, None)
    np.testing.assert_array_equal(first[0], second[0])
    np.testing.assert_array_equal(first[1], second[1])


def covariance(seen: View, noise_m: float, seed: int = 0) -> NDArray[np.float64]:
    """Covariance when the view's own points are ``noise_m`` off on each axis."""
    noise = np.random.default_rng(seed).normal(size=seen.points_base.shape) * noise_m
    measured = transform(inverse(seen.T_ref_base), seen.points_ref) + noise
    return spread_covariance(seen.points_ref, measured.astype(np.float32), seen.T_ref_base, CAMERA, PARAMS)


def test_covariance_grows_with_the_square_of_the_noise() -> None:
    seen = view(1, 400)
    small, large = covariance(seen, 0.005), covariance(seen, 0.05)
    np.testing.assert_allclose(large.diagonal() / small.diagonal(), 100, rtol=0.1)


def test_linear_variance_is_the_scaled_quartile_of_the_squared_distances() -> None:
    seen = view(1, 100)
    offsets = np.zeros((100, 3))
    offsets[:, 0] = np.random.default_rng(0).permutation(np.arange(100)) * 0.001
    measured = transform(inverse(seen.T_ref_base), seen.points_ref) + offsets
    found = spread_covariance(seen.points_ref, measured.astype(np.float32), seen.T_ref_base, CAMERA, PARAMS)
    np.testing.assert_allclose(found.diagonal()[:3], 2.1981 * 0.025**2, rtol=1e-3)
    half = PARAMS.changed({"Vis/PnPVarianceMedianRatio": 2})
    found = spread_covariance(seen.points_ref, measured.astype(np.float32), seen.T_ref_base, CAMERA, half)
    np.testing.assert_allclose(found.diagonal()[:3], 2.1981 * 0.050**2, rtol=1e-3)


def test_each_axis_of_the_base_may_have_its_own_variance() -> None:
    seen = view(1, 100)
    apart = np.random.default_rng(0).permutation(np.arange(100))[:, None] * np.array([0.001, 0.002, 0.003])
    measured = (transform(inverse(seen.T_ref_base), seen.points_ref) + apart).astype(np.float32)
    split = PARAMS.changed({"Vis/PnPSplitLinearCovComponents": True})
    found = spread_covariance(seen.points_ref, measured, seen.T_ref_base, CAMERA, split)
    np.testing.assert_allclose(found.diagonal()[:3], 2.1981 * np.array([0.025, 0.05, 0.075]) ** 2, rtol=1e-3)
    together = spread_covariance(seen.points_ref, measured, seen.T_ref_base, CAMERA, PARAMS)
    np.testing.assert_array_equal(found.diagonal()[3:], together.diagonal()[3:])


def test_perfect_agreement_still_leaves_a_variance() -> None:
    assert (covariance(view(1, 50), 0.0).diagonal() >= [1e-8] * 3 + [3e-8] * 3).all()


@quickly
@given(seeds, st.floats(1e-4, 0.1))
def test_covariance_is_positive_and_as_unsure_of_the_turn_as_of_the_sidestep(seed: int, noise_m: float) -> None:
    seen = view(seed, 60)
    found = covariance(seen, noise_m, seed)
    depth = np.median(transform(seen.T_cam_ref, seen.points_ref)[:, 2])
    assert (np.linalg.eigvalsh(found) > 0).all()
    assert found[3, 3] >= found[0, 0] / depth**2 * (1 - 1e-6)


@pytest.mark.parametrize("known", [0, 1, 3, 4])
def test_a_view_without_depth_is_unsure_but_not_lost(known: int) -> None:
    # 9999 would mean that odometry began anew, and start a session.
    seen = view(1, 50)
    measured = transform(inverse(seen.T_ref_base), seen.points_ref).astype(np.float32)
    measured[known:] = np.nan
    found = spread_covariance(seen.points_ref, measured, seen.T_ref_base, CAMERA, PARAMS).diagonal()
    assert (found < 0.01 * UNKNOWN_VARIANCE).all()
    if known < 4:
        depths = transform(seen.T_cam_ref, seen.points_ref)[:, 2]
        assert 0.05 * depths.min() < np.sqrt(found[0]) < 0.3 * depths.max()
        assert np.sqrt(found[3]) > 0.05


def test_tangents_of_the_truth_lie_within_what_the_covariance_allows() -> None:
    errors = []
    for seed in range(30):
        seen = view(seed, 200, pixel_noise=0.7, depth_noise=0.7)
        T_ref_base, inliers = solved(seen, None)
        found = spread_covariance(seen.points_ref[inliers], seen.points_base[inliers], T_ref_base, CAMERA, PARAMS)
        T = between(seen.T_ref_base, T_ref_base)
        errors.append(translation_norm(T) / np.sqrt(found[0, 0]))
    assert np.mean(np.array(errors) < 3) > 0.95
