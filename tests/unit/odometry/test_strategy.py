"""Every way to track: against a map or a key frame, with odometry from outside as the guess or alone, smoothed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from slam.errors import ParameterError, SourceError
from slam.evaluate import absolute_error
from slam.geometry import Pose, between, inverse, make, so3_exp, to_quat_xyzw, translation_norm
from slam.odometry.kalman import VelocityFilter
from slam.odometry.strategy import make_tracker
from slam.params import Params
from slam.sensors.wheels import Wheels
from slam.types import UNKNOWN_VARIANCE, ExternalOdometry, Frame, Odometry
from tests.tours import dense, truth


def tracked(frames: tuple[Frame, ...] | list[Frame], **changes: float) -> list[Odometry]:
    params = Params().changed({name.replace("_", "/", 1): value for name, value in changes.items()})
    tracker = make_tracker(params)
    return [tracker.track(frame, params) for frame in frames]


def poses(found: list[Odometry]) -> list[Pose]:
    return [odometry.T_odom_base for odometry in found if odometry.T_odom_base is not None]


def with_wheels(frames: tuple[Frame, ...] | list[Frame]) -> list[Frame]:
    """Frames whose external odometry is the truth, in a frame of its own."""
    true = truth(frames)
    T_own_world = make(so3_exp(np.array([0.0, 0.0, 1.0])), np.array([3.0, -2.0, 0.0]))
    given = [ExternalOdometry(T_own_world @ T, np.array([1e-4, 1e-5]) * k) for k, T in enumerate(true)]
    return [replace(frame, external=one) for frame, one in zip(frames, given, strict=True)]


def test_frame_to_frame_tracks_and_drifts_a_little_more() -> None:
    found = tracked(dense(), Odom_Strategy=1)
    assert len(poses(found)) == len(dense())
    assert absolute_error(truth(dense()), poses(found)).rmse_m < 0.02


def test_external_odometry_alone_is_taken_as_it_is() -> None:
    frames = with_wheels(dense())
    found = tracked(frames, Odom_External=2)
    assert absolute_error(truth(frames), poses(found)).rmse_m < 1e-9
    assert found[0].covariance[0, 0] == UNKNOWN_VARIANCE
    assert found[1].covariance[0, 0] == pytest.approx(1e-4) and found[1].covariance[5, 5] == pytest.approx(1e-5)
    lost = tracked(dense()[:1], Odom_External=2)[0].lost
    assert lost is not None and "odometry.txt" in lost.text


def test_external_odometry_as_the_guess_bridges_a_jump() -> None:
    """Every ninth frame only: too far for a guess that expects the last motion again, not for one that knows."""
    frames = with_wheels(dense())[::9]
    guessed = tracked(frames, Odom_External=1)
    assert len(poses(guessed)) == len(frames)
    assert absolute_error(truth(frames), poses(guessed)).rmse_m < 0.02


def test_what_is_no_strategy_is_refused() -> None:
    with pytest.raises(ParameterError, match="Odom/Strategy"):
        Params().changed({"Odom/Strategy": 7})


def test_the_filter_takes_out_jitter_and_never_drifts() -> None:
    params = Params().changed({"Odom/FilteringStrategy": 1})
    rng, smooth = np.random.default_rng(0), VelocityFilter()
    step = np.array([0.01, 0.0, 0.0])
    true = [make(np.eye(3), k * step) for k in range(300)]
    noisy = [make(np.eye(3), T[:3, 3] + rng.normal(0, 0.002, 3)) for T in true]
    found = [smooth.smooth(T, k / 30, params) for k, T in enumerate(noisy)]

    def jitter(path: list[Pose]) -> float:
        return float(np.std([translation_norm(between(a, b)) for a, b in pairwise(path[100:])]))

    assert jitter(found) < 0.5 * jitter(noisy)
    assert max(np.linalg.norm(a[:3, 3] - b[:3, 3]) for a, b in zip(found, true, strict=True)) < 0.02


def test_without_a_filter_the_tracked_pose_is_reported() -> None:
    smooth, T = VelocityFilter(), make(np.eye(3), np.ones(3))
    assert smooth.smooth(np.eye(4), 0.0, Params()) is not None
    np.testing.assert_array_equal(smooth.smooth(T, 0.1, Params()), T)


def test_wheels_of_increments_and_of_poses_agree(tmp_path: Path) -> None:
    arc = make(so3_exp(np.array([0.0, 0.0, 0.1])), np.array([0.2, 0.05, 0.0]))
    lines, T = ["# increments"], np.eye(4)
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    stamped = []
    for k in range(20):
        T = T @ arc
        lines.append(f"{k / 10} 0.2 0.05 0.1 0.01 0.002")
        stamped.append(f"{k / 10} " + " ".join(str(v) for v in [*T[:3, 3], *to_quat_xyzw(T)]))
    (tmp_path / "a" / "wheels.txt").write_text("\n".join(lines))
    (tmp_path / "b" / "odometry.txt").write_text("\n".join(stamped))
    by_steps, by_poses = Wheels.read(tmp_path / "a"), Wheels.read(tmp_path / "b")
    for stamp in (0.0, 0.5, 0.55, 1.9):
        one, other = by_steps.at(stamp), by_poses.at(stamp)
        assert one is not None and other is not None
        np.testing.assert_allclose(inverse(one.T_odom_base) @ other.T_odom_base, np.eye(4), atol=1e-6)
    assert by_steps.at(2.5) is None and by_steps.at(-1.0) is None
    late = by_steps.at(1.9)
    assert late is not None and late.variances[0] == pytest.approx(20 * 0.01**2)


def test_a_bad_line_is_named(tmp_path: Path) -> None:
    (tmp_path / "wheels.txt").write_text("0.0 0.1 0 0\n")
    with pytest.raises(SourceError, match=r"wheels\.txt:1"):
        Wheels.read(tmp_path)
