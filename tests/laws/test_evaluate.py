"""Laws of the trajectory errors."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.errors import SlamError
from slam.evaluate import absolute_error, align, associated, error_per_metre, error_per_second
from slam.geometry import Pose, inverse, make, se3_exp, so3_exp

seeds = st.integers(0, 10_000)
motions = st.builds(
    lambda turn, shift: make(so3_exp(np.array(turn)), np.array(shift)),
    st.tuples(*[st.floats(-1.7, 1.7)] * 3),
    st.tuples(*[st.floats(-20, 20)] * 3),
)


def walk(seed: int, count: int = 60, step: float = 0.1) -> np.ndarray:
    """A random smooth trajectory (count, 4, 4) with steps of about this many metres."""
    rng = np.random.default_rng(seed)
    poses = [se3_exp(rng.normal(0, 1, 6))]
    for _ in range(count - 1):
        tangent = np.concatenate([[step, 0, 0], np.zeros(3)]) + rng.normal(0, 0.02, 6)
        poses.append(poses[-1] @ se3_exp(tangent))
    return np.array(poses)


def disturbed(trajectory: np.ndarray, seed: int, amount: float = 0.02) -> np.ndarray:
    rng = np.random.default_rng(seed + 1)
    return np.array([T @ se3_exp(rng.normal(0, amount, 6)) for T in trajectory])


@given(seeds, motions)
def test_a_moved_copy_has_no_error(seed: int, T: Pose) -> None:
    truth = walk(seed)
    found = absolute_error(truth, T @ truth)
    assert max(found.rmse_m, found.mean_m, found.median_m, found.max_m) < 1e-9
    assert found.pairs == len(truth)
    for relative in (error_per_metre(truth, T @ truth), error_per_second(truth, T @ truth, np.arange(60) / 10)):
        assert relative.translation_rmse < 1e-9
        assert relative.rotation_rmse_deg < 1e-5


@given(seeds, motions, motions)
def test_errors_do_not_see_where_the_frames_are(seed: int, A: Pose, B: Pose) -> None:
    truth = walk(seed)
    estimate = disturbed(truth, seed)
    plain, moved = absolute_error(truth, estimate), absolute_error(A @ truth, B @ estimate)
    for entry in fields(plain):
        assert getattr(moved, entry.name) == pytest.approx(getattr(plain, entry.name), abs=1e-9)
    a, b = error_per_metre(truth, estimate), error_per_metre(A @ truth, B @ estimate)
    assert (b.translation_rmse, b.rotation_rmse_deg, b.pairs) == pytest.approx(
        (a.translation_rmse, a.rotation_rmse_deg, a.pairs), abs=1e-7
    )


@given(seeds, st.floats(0.5, 0.95) | st.floats(1.05, 2.0))
def test_scale_is_an_error(seed: int, scale: float) -> None:
    truth = walk(seed)
    estimate = truth.copy()
    estimate[:, :3, 3] *= scale
    spread = truth[:, :3, 3] - truth[:, :3, 3].mean(axis=0)
    expected = abs(scale - 1) * np.sqrt(np.mean(np.sum(spread**2, axis=1)))
    assert absolute_error(truth, estimate).rmse_m == pytest.approx(expected, rel=1e-6)
    assert error_per_metre(truth, estimate).translation_rmse > 0.5 * abs(scale - 1)


@given(seeds)
def test_truth_and_estimate_may_change_places(seed: int) -> None:
    truth = walk(seed)
    estimate = disturbed(truth, seed)
    assert absolute_error(truth, estimate).rmse_m == pytest.approx(absolute_error(estimate, truth).rmse_m)


@given(seeds)
def test_mean_median_and_rmse_are_in_order(seed: int) -> None:
    truth = walk(seed)
    found = absolute_error(truth, disturbed(truth, seed))
    assert 0 < found.median_m <= found.max_m
    assert 0 < found.mean_m <= found.rmse_m <= found.max_m


@given(seeds, motions)
def test_no_other_motion_aligns_better(seed: int, T: Pose) -> None:
    rng = np.random.default_rng(seed)
    a = rng.normal(0, 3, (20, 3))
    b = a @ T[:3, :3].T + T[:3, 3] + rng.normal(0, 0.1, (20, 3))
    T_a_b = align(a, b)

    def cost(T_a_b: Pose) -> float:
        return float(np.sum((b @ T_a_b[:3, :3].T + T_a_b[:3, 3] - a) ** 2))

    assert np.linalg.det(T_a_b[:3, :3]) == pytest.approx(1.0)
    assert all(cost(T_a_b) <= cost(T_a_b @ se3_exp(rng.normal(0, 0.05, 6))) for _ in range(20))
    assert np.allclose(align(b, a), inverse(T_a_b), atol=1e-6)


@given(seeds)
def test_mirrored_points_are_turned_not_mirrored(seed: int) -> None:
    a = np.random.default_rng(seed).normal(0, 1, (10, 3))
    assert np.linalg.det(align(a, a * [1, 1, -1])[:3, :3]) == pytest.approx(1.0)


@given(seeds, st.floats(0.001, 0.05), st.sampled_from([0.5, 1.0, 2.0]))
def test_drift_per_metre_is_what_was_put_in(seed: int, drift: float, step: float) -> None:
    truth = np.array([make(np.eye(3), np.array([0.05 * k, 0, 0])) for k in range(200)])
    estimate = truth.copy()
    estimate[:, 1, 3] += drift * truth[:, 0, 3]
    found = error_per_metre(truth, estimate, step)
    assert found.translation_rmse == pytest.approx(drift, rel=1e-6)
    assert found.rotation_rmse_deg == pytest.approx(0.0, abs=1e-6)
    stamps = np.arange(200) * 0.1
    assert error_per_second(truth, estimate, stamps).translation_rmse == pytest.approx(0.5 * drift, rel=1e-6)
    del seed


def test_turning_drift_is_in_degrees_per_second() -> None:
    truth = np.tile(np.eye(4), (50, 1, 1))
    estimate = np.array([make(so3_exp(np.array([0, 0, np.radians(0.3 * k)])), np.zeros(3)) for k in range(50)])
    found = error_per_second(truth, estimate, np.arange(50) / 10)
    assert found.rotation_rmse_deg == pytest.approx(3.0)
    assert found.translation_rmse == pytest.approx(0.0)


def test_a_short_path_has_no_steps() -> None:
    truth = walk(0, count=5)
    found = error_per_metre(truth, truth)
    assert found.pairs == 0
    assert np.isnan(found.translation_rmse)


@given(seeds)
def test_poses_are_matched_by_their_stamps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = walk(seed)
    stamps = 100 + np.arange(len(truth)) / 30
    kept = np.flatnonzero(rng.random(len(truth)) < 0.7)
    a, b = associated(stamps, truth, stamps[kept] + 0.004, truth[kept])
    assert len(a) == len(kept)
    assert np.array_equal(a, b)


@pytest.mark.parametrize(("true", "found"), [(0, 0), (3, 4)])
def test_what_cannot_be_compared_is_refused(true: int, found: int) -> None:
    with pytest.raises(SlamError, match=f"{true} true and {found} found positions"):
        absolute_error(walk(0, true) if true else np.empty((0, 4, 4)), walk(0, found) if found else np.empty((0, 4, 4)))
