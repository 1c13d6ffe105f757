"""Which way is up."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.camera import Camera
from slam.geometry import so3_exp, to_euler_rpy
from slam.sensors.gravity import GRAVITY, R_CAM_ACCELEROMETER, Gravity, level

CAMERA = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@given(directions)
def test_level_turns_up_to_z(up: tuple[float, float, float]) -> None:
    T_gravity_base = level(np.array(up))
    R = T_gravity_base[:3, :3]
    assert np.allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.isclose(np.linalg.det(R), 1.0)
    assert np.allclose(R @ np.array(up), [0, 0, np.linalg.norm(up)], atol=1e-9)
    assert np.allclose(T_gravity_base[:3, 3], 0.0)


@given(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
def test_level_keeps_roll_and_pitch_and_has_no_yaw(roll: float, pitch: float) -> None:
    R = so3_exp(np.array([0.0, 0.0, 2.0])) @ so3_exp(np.array([0.0, pitch, 0.0])) @ so3_exp(np.array([roll, 0.0, 0.0]))
    assert np.allclose(to_euler_rpy(level(R[2])), [roll, pitch, 0.0], atol=1e-9)


def at_rest(up_cam: np.ndarray, stamps: np.ndarray) -> Gravity:
    return Gravity(stamps, np.tile(GRAVITY * R_CAM_ACCELEROMETER.T @ up_cam, (len(stamps), 1)))


def test_a_level_camera_at_rest_is_level() -> None:
    found = at_rest(np.array([0.0, -1.0, 0.0]), np.arange(0, 1, 0.002)).at(0.5, CAMERA)
    assert found is not None
    assert np.allclose(found, np.eye(4), atol=1e-12)


def test_a_camera_that_looks_down_has_its_base_pitched_down() -> None:
    found = at_rest(np.array([0.0, -np.cos(0.3), -np.sin(0.3)]), np.arange(0, 1, 0.002)).at(0.5, CAMERA)
    assert found is not None
    assert np.allclose(to_euler_rpy(found), [0.0, 0.3, 0.0], atol=1e-9)


def test_the_mean_takes_half_a_second() -> None:
    stamps = np.arange(0, 2, 0.01)
    forces = np.tile([0.0, GRAVITY, 0.0], (len(stamps), 1))
    forces[:, 0] = np.where(np.arange(len(stamps)) % 2, 3.0, -3.0)
    found = Gravity(stamps, forces).at(1.0, CAMERA)
    assert found is not None
    assert np.degrees(np.arccos(found[2, 2])) < 0.5


def test_none_without_samples_or_when_shaken() -> None:
    stamps = np.arange(0, 1, 0.01)
    assert at_rest(np.array([0.0, -1.0, 0.0]), stamps).at(5.0, CAMERA) is None
    assert at_rest(np.array([0.0, -1.3, 0.0]), stamps).at(0.5, CAMERA) is None
    assert Gravity(np.empty(0), np.empty((0, 3))).at(0.5, CAMERA) is None
