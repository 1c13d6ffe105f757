"""Ground truth between its samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.geometry import between, interpolate, make, se3_exp, se3_log, so3_exp, to_quat_xyzw
from slam.sensors.truth import Truth

STAMPS = np.array([10.0, 10.03, 10.06, 10.30, 10.33])
POSES = [make(so3_exp(np.array([0.0, 0.1 * k, 0.2])), np.array([k, 2.0 * k, 0.5])) for k in range(5)]
TRUTH = Truth(STAMPS, np.array([T[:3, 3] for T in POSES]), np.array([to_quat_xyzw(T) for T in POSES]))


def test_samples_are_returned_as_they_are() -> None:
    for stamp, pose in zip(STAMPS, POSES, strict=True):
        for shift in (0.0, 5e-5, -5e-5):
            assert np.allclose(TRUTH.at(stamp + shift), pose, atol=1e-12)


@given(st.floats(10.001, 10.029))
def test_between_samples_the_motion_is_even(stamp: float) -> None:
    found = TRUTH.at(stamp)
    assert found is not None
    assert np.allclose(found, interpolate(POSES[0], POSES[1], (stamp - 10.0) / 0.03), atol=1e-9)
    whole, part = se3_log(between(POSES[0], POSES[1])), se3_log(between(POSES[0], found))
    assert np.allclose(se3_exp(whole * (stamp - 10.0) / 0.03), se3_exp(part), atol=1e-9)


@pytest.mark.parametrize("stamp", [9.99, 10.07, 10.2, 10.29, 10.34, 0.0, 1e9])
def test_there_is_none_outside_and_inside_gaps(stamp: float) -> None:
    assert TRUTH.at(stamp) is None


def test_no_file_is_no_truth(tmp_path: Path) -> None:
    truth = Truth.read(tmp_path / "groundtruth.txt")
    assert (len(truth), truth.at(1.0)) == (0, None)
