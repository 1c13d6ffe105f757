"""Odometry on the tour: how far it may drift, how it says that it is lost, and how it comes back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.evaluate import absolute_error
from slam.geometry import between, rotation_angle, translation_norm
from slam.odometry import frame_to_map
from slam.odometry.frame_to_map import FrameToMap
from slam.odometry.local_map import LocalMap
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Frame, Odometry
from tests.tours import blank, covered, dense, sparse, truth

PARAMS = Params()


def tracked(frames: list[Frame] | tuple[Frame, ...], params: Params = PARAMS) -> list[Odometry]:
    odometry = FrameToMap(LocalMap())
    return [odometry.track(frame, params) for frame in frames]


@pytest.fixture(scope="module")
def calm() -> list[Odometry]:
    return tracked(dense())


def test_a_second_of_the_tour_is_tracked_to_a_centimetre(calm: list[Odometry]) -> None:
    poses = [found.T_odom_base for found in calm if found.T_odom_base is not None]
    assert len(poses) == len(dense())
    error = absolute_error(truth(dense()), poses)
    assert error.rmse_m < 0.006
    true, found = truth(dense()), poses
    for k in range(1, len(poses)):
        step = between(between(true[k - 1], true[k]), between(found[k - 1], found[k]))
        assert translation_norm(step) < 0.015
        assert rotation_angle(step) < np.radians(0.3)


def test_wide_steps_are_tracked_too() -> None:
    frames = sparse()[:30]
    found = tracked(frames)
    poses = [one.T_odom_base for one in found if one.T_odom_base is not None]
    assert len(poses) == 30
    assert absolute_error(truth(frames), poses).rmse_m < 0.05


def test_a_fast_turn_is_followed_where_all_places_look_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frame_to_map, "match_all", lambda *_, **__: np.zeros((0, 2), np.int32))
    frames = sparse()[:30]
    unforeseen = PARAMS.changed({"Odom/GuessMotion": False, "Vis/CorGuessWinSize": 20})
    poses = [one.T_odom_base for one in tracked(frames, unforeseen) if one.T_odom_base is not None]
    assert len(poses) == 30
    assert absolute_error(truth(frames), poses).rmse_m < 0.05


@pytest.mark.parametrize("adjust", [True, False])
def test_with_and_without_bundle_adjustment(adjust: bool) -> None:
    params = PARAMS.changed({"OdomF2M/BundleAdjustment": adjust})
    poses = [one.T_odom_base for one in tracked(sparse()[:15], params) if one.T_odom_base is not None]
    assert len(poses) == 15
    assert absolute_error(truth(sparse()[:15]), poses).rmse_m < 0.05


def test_results_carry_their_evidence(calm: list[Odometry]) -> None:
    for found in calm[1:]:
        assert PARAMS.Vis.MinInliers <= found.inliers <= found.matches <= len(found.features)
        assert found.covariance[0, 0] < 1
        assert (np.linalg.eigvalsh(found.covariance) > 0).all()
        assert found.lost is None
        assert found.time_ms > 0
        assert found.T_odom_base is not None
        R = found.T_odom_base[:3, :3]
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9


def test_the_first_frame_begins_the_chain_level(calm: list[Odometry]) -> None:
    first = calm[0]
    assert first.keyframe
    assert (first.covariance.diagonal() == UNKNOWN_VARIANCE).all()
    assert first.T_odom_base is not None
    gravity = dense()[0].T_gravity_base
    assert gravity is not None
    np.testing.assert_array_equal(first.T_odom_base, gravity)
    still = tracked([replace(dense()[0], T_gravity_base=None)])[0]
    assert still.T_odom_base is not None
    np.testing.assert_array_equal(still.T_odom_base, np.eye(4))


def test_level_even_if_the_first_frames_show_nothing() -> None:
    found = tracked([blank(dense()[0]), blank(dense()[1]), *dense()[2:4]])
    assert found[0].lost is not None
    assert found[0].lost.text == "0 features with depth, fewer than Vis/MinInliers 20"
    assert found[2].T_odom_base is not None
    gravity = dense()[2].T_gravity_base
    assert gravity is not None
    np.testing.assert_array_equal(found[2].T_odom_base, gravity)


def test_blank_frames_are_lost_with_numbers_and_the_next_is_found_again() -> None:
    found = tracked(covered(dense(12), [5, 6, 7]))
    for one in found[5:8]:
        assert one.T_odom_base is None
        assert (one.covariance.diagonal() == UNKNOWN_VARIANCE).all()
        assert one.lost is not None
        assert one.lost.test == "Vis/MinInliers"
        assert one.lost.value == one.inliers == 0
        assert one.lost.threshold == 20
        assert one.lost.text == "0 inliers, fewer than Vis/MinInliers 20"
    assert found[8].T_odom_base is not None
    assert found[8].covariance[0, 0] < 1
    first = found[0].T_odom_base
    assert first is not None
    error = between(between(truth(dense())[0], truth(dense())[8]), between(first, found[8].T_odom_base))
    assert translation_norm(error) < 0.03


def test_it_waits_for_known_sights_as_long_as_it_takes() -> None:
    found = tracked([*dense()[:3], *[blank(dense()[0])] * 12, dense()[3]])
    assert [one.T_odom_base is None for one in found] == [False] * 3 + [True] * 12 + [False]


@pytest.mark.parametrize("countdown", [1, 3])
def test_a_countdown_starts_anew_with_unknown_covariance(countdown: int) -> None:
    params = PARAMS.changed({"Odom/ResetCountdown": countdown})
    found = tracked(covered(dense(12), range(4, 4 + countdown)), params)
    after = found[4 + countdown]
    assert after.T_odom_base is not None
    assert after.keyframe
    assert (after.covariance.diagonal() == UNKNOWN_VARIANCE).all()
    assert all(one.T_odom_base is not None and one.covariance[0, 0] < 1 for one in found[5 + countdown :])
    short = tracked(covered(dense(12), range(4, 3 + countdown)), params)
    assert all(one.covariance[0, 0] < 1 for one in short[1:] if one.T_odom_base is not None), "one too few to reset"


def test_the_countdown_counts_frames_in_a_row() -> None:
    params = PARAMS.changed({"Odom/ResetCountdown": 2})
    found = tracked(covered(dense(12), [4, 6, 8]), params)
    assert all(one.covariance[0, 0] < 1 for one in found[1:] if one.T_odom_base is not None)


def test_without_depth_tracking_goes_on() -> None:
    dark = [replace(f, depth_m=np.zeros_like(f.depth_m)) if 5 <= k < 8 else f for k, f in enumerate(dense(12))]
    found = tracked(dark)
    assert all(one.T_odom_base is not None for one in found)
    assert all(one.covariance[0, 0] < 1 for one in found[1:])
    assert found[6].covariance[0, 0] > 4 * found[4].covariance[0, 0]


@pytest.mark.parametrize(("name", "value", "all_keys"), [("Odom/VisKeyFrameThr", 1000, True), ("both", 0, False)])
def test_key_frames_follow_their_thresholds(name: str, value: float, all_keys: bool) -> None:
    changes = {name: value} if name != "both" else {"Odom/VisKeyFrameThr": 0, "Odom/KeyFrameThr": 0.0}
    found = tracked(dense(6), PARAMS.changed(changes))
    assert [one.keyframe for one in found[1:]] == [all_keys] * 5


def test_tracking_is_repeatable_bit_for_bit(calm: list[Odometry]) -> None:
    for one, again in zip(calm, tracked(dense()), strict=True):
        assert one.T_odom_base is not None
        assert again.T_odom_base is not None
        np.testing.assert_array_equal(one.T_odom_base, again.T_odom_base)
        np.testing.assert_array_equal(one.covariance, again.covariance)
