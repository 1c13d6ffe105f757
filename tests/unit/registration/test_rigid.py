"""3D-3D: the motion between two sets of measured points, whatever part of them is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.geometry import Pose, between, inverse, rotation_angle, transform, translation_norm
from slam.params import Params, Value
from slam.registration.rigid import fit, solve_rigid
from tests.scenes import CAMERA, random_pose

PARAMS = Params()
seeds = st.integers(0, 10_000)
Points = NDArray[np.float64]


def pairs(seed: int, count: int = 100, *, noise: float = 0.0, outliers: float = 0.0) -> tuple[Points, Points, Pose]:
    """Points in both frames, and ``T_ref_base``; the first ones are wrong."""
    rng = np.random.default_rng(seed)
    T_ref_base = random_pose(rng, 2.0, 1.5)
    points_ref = rng.uniform((1, -2, -1), (5, 2, 2), (count, 3))
    points_base = transform(inverse(T_ref_base), points_ref) + rng.normal(size=(count, 3)) * noise
    wrong = round(count * outliers)
    points_base[:wrong] = rng.uniform((1, -2, -1), (5, 2, 2), (wrong, 3))
    return points_ref, points_base, T_ref_base


def solved(ref: Points, base: Points, guess: Pose | None = None, **values: Value) -> tuple[Pose, NDArray[np.bool_]]:
    params = PARAMS.changed({f"Vis/{name}": value for name, value in values.items()})
    pixels = np.zeros((len(ref), 2), np.float32)
    return solve_rigid(ref, pixels, base.astype(np.float32), CAMERA, params, T_ref_base=guess)


@settings(max_examples=25)
@given(seeds, st.sampled_from([0.0, 0.3, 0.6]))
def test_the_motion_is_found_among_outliers(seed: int, outliers: float) -> None:
    ref, base, T_ref_base = pairs(seed, noise=0.01, outliers=outliers)
    found, inliers = solved(ref, base)
    assert translation_norm(between(T_ref_base, found)) < 0.03
    assert rotation_angle(between(T_ref_base, found)) < 0.01
    wrong = round(100 * outliers)
    assert inliers[wrong:].mean() > 0.9
    assert not inliers[:wrong].any() or inliers[:wrong].mean() < 0.05
    R = found[:3, :3]
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-12


@settings(max_examples=25)
@given(seeds, st.integers(3, 20))
def test_exact_pairs_are_fitted_exactly_and_never_mirrored(seed: int, count: int) -> None:
    ref, base, T_ref_base = pairs(seed, count)
    R, t = fit(ref, base)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R @ base.T + t[:, None], ref.T, atol=1e-6)
    np.testing.assert_allclose(R, T_ref_base[:3, :3], atol=1e-4)
    mirrored, _ = fit(ref, base * [1.0, 1.0, -1.0])
    assert np.linalg.det(mirrored) == pytest.approx(1.0)


def test_inliers_lie_within_the_distance_and_refining_brings_them_nearer() -> None:
    ref, base, T_ref_base = pairs(1, 200, noise=0.01)
    base[:40] += [0.0, 0.0, 0.07]
    _, coarse = solved(ref, base, RefineIterations=0)
    assert coarse[:40].any()
    found, fine = solved(ref, base)
    assert fine[:40].mean() < 0.1
    assert fine[40:].mean() > 0.9
    assert translation_norm(between(T_ref_base, found)) < 0.01
    wide, all_of_them = solved(ref, base, InlierDistance=0.5, RefineIterations=0)
    assert all_of_them.all()
    assert np.isfinite(wide).all()


def test_pairs_without_depth_are_no_inliers() -> None:
    ref, base, T_ref_base = pairs(2, 60)
    base[::3] = np.nan
    found, inliers = solved(ref, base)
    np.testing.assert_allclose(found, T_ref_base, atol=1e-4)
    np.testing.assert_array_equal(inliers, np.arange(60) % 3 != 0)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_three_pairs_are_needed(count: int) -> None:
    ref, base, _ = pairs(3, 10)
    base[count:] = np.nan
    guess = random_pose(np.random.default_rng(0))
    found, inliers = solved(ref, base, guess)
    np.testing.assert_array_equal(found, guess)
    assert not inliers.any()


def test_a_good_guess_is_the_first_to_beat() -> None:
    ref, base, T_ref_base = pairs(4, 100, outliers=0.97)
    assert solved(ref, base, Iterations=1)[1][97:].sum() < 3
    found, inliers = solved(ref, base, T_ref_base, Iterations=1)
    assert inliers[97:].all()
    assert translation_norm(between(T_ref_base, found)) < 0.05


def test_the_same_pairs_give_the_same_pose_bit_for_bit() -> None:
    ref, base, _ = pairs(5, noise=0.02, outliers=0.5)
    np.testing.assert_array_equal(solved(ref, base)[0], solved(ref, base)[0])
