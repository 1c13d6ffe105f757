"""Rigid motions: conventions fixed by examples that one can check by hand."""

from __future__ import annotations

import numpy as np
import pytest

from slam import geometry as g

QUARTER = np.pi / 2


def test_composition_reads_by_cancelling() -> None:
    T_map_odom = g.make(g.so3_exp(np.array([0, 0, QUARTER])), np.array([1.0, 0.0, 0.0]))
    T_odom_base = g.make(np.eye(3), np.array([2.0, 0.0, 0.0]))
    assert np.allclose((T_map_odom @ T_odom_base)[:3, 3], [1.0, 2.0, 0.0])
    assert np.allclose(g.transform(T_map_odom, np.array([[2.0, 0.0, 5.0]])), [[1.0, 2.0, 5.0]])


def test_hat_is_the_cross_product() -> None:
    v, w = np.array([1.0, 2.0, 3.0]), np.array([-4.0, 0.5, 2.0])
    assert np.allclose(g.hat(v) @ w, np.cross(v, w))


def test_rotations_are_right_handed() -> None:
    assert np.allclose(g.so3_exp(np.array([0, 0, QUARTER])) @ [1, 0, 0], [0, 1, 0])
    assert np.allclose(g.so3_exp(np.array([QUARTER, 0, 0])) @ [0, 1, 0], [0, 0, 1])


def test_quaternions_are_ordered_x_y_z_w() -> None:
    half = np.sqrt(0.5)
    assert np.allclose(g.to_quat_xyzw(g.so3_exp(np.array([0, 0, QUARTER]))), [0, 0, half, half])
    T = g.from_quat_xyzw(np.array([half, 0, 0, half]), np.array([1.0, 2.0, 3.0]))
    assert np.allclose(T[:3, :3] @ [0, 1, 0], [0, 0, 1])
    assert np.allclose(T[:3, 3], [1, 2, 3])


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_have_their_quaternion(axis: int) -> None:
    R = -np.eye(3)
    R[axis, axis] = 1.0
    expected = np.zeros(4)
    expected[axis] = 1.0
    assert np.allclose(np.abs(g.to_quat_xyzw(R)), expected)
    assert np.isclose(np.linalg.norm(g.so3_log(R)), np.pi)


def test_tangents_have_translation_first() -> None:
    tangent = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0])
    assert np.allclose(g.se3_exp(tangent)[:3, 3], [1, 2, 3])
    screw = g.se3_exp(np.array([0.0, 0.0, 1.0, 0.0, 0.0, QUARTER]))
    assert np.allclose(screw, g.make(g.so3_exp(np.array([0, 0, QUARTER])), np.array([0.0, 0.0, 1.0])))


def test_a_quarter_circle_ends_beside_its_centre() -> None:
    T = g.se3_exp(np.array([QUARTER, 0.0, 0.0, 0.0, 0.0, QUARTER]))
    assert np.allclose(T[:3, 3], [1.0, 1.0, 0.0]), "driving a quarter of a circle of radius one"


def test_lengths_and_angles() -> None:
    T = g.make(g.so3_exp(np.array([0.0, 0.3, 0.0])), np.array([3.0, 0.0, 4.0]))
    assert g.translation_norm(T) == 5.0
    assert g.rotation_angle(T) == pytest.approx(0.3)


def test_euler_angles_are_roll_pitch_yaw() -> None:
    assert np.allclose(g.to_euler_rpy(g.so3_exp(np.array([0.1, 0, 0]))), [0.1, 0, 0])
    assert np.allclose(g.to_euler_rpy(g.so3_exp(np.array([0, 0.1, 0]))), [0, 0.1, 0])
    assert np.allclose(g.to_euler_rpy(g.so3_exp(np.array([0, 0, 0.1]))), [0, 0, 0.1])


def test_results_are_float64_and_new() -> None:
    T = np.eye(4)
    for made in (g.inverse(T), g.interpolate(T, T, 0.5), g.make(np.eye(3), np.zeros(3))):
        assert made.dtype == np.float64
        assert not np.shares_memory(made, T)
