"""Laws of rigid motions: the group's axioms, and charts that agree near the identity and near half a turn."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from slam import geometry as g

unit = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3)
axes = unit.map(lambda v: np.array(v) / np.linalg.norm(v))
#: Angles of every kind: tiny, ordinary, close to half a turn, exactly there.
angles = st.one_of(
    st.floats(0, np.pi),
    st.floats(-16, -3).map(lambda e: 10.0**e),
    st.floats(-16, -3).map(lambda e: np.pi - 10.0**e),
    st.sampled_from([0.0, 1e-8, 1e-4, np.pi / 2, np.pi]),
)
vectors = st.tuples(*[st.floats(-50, 50)] * 3).map(np.array)
rotations = st.builds(lambda axis, angle: g.so3_exp(axis * angle), axes, angles)
poses = st.builds(g.make, rotations, vectors)
tangents = st.builds(lambda rho, axis, angle: np.concatenate([rho, axis * angle]), vectors, axes, angles)


def close(a: np.ndarray, b: np.ndarray, tolerance: float = 1e-9) -> bool:
    """Equal but for rounding, of numbers up to some hundreds."""
    return bool(np.allclose(a, b, atol=tolerance, rtol=1e-9))


@given(poses)
def test_poses_are_rigid(T: np.ndarray) -> None:
    R = T[:3, :3]
    assert close(R @ R.T, np.eye(3), 1e-12)
    assert np.isclose(np.linalg.det(R), 1.0)
    assert np.array_equal(T[3], [0, 0, 0, 1])


@given(poses)
def test_inverse(T: np.ndarray) -> None:
    assert close(T @ g.inverse(T), np.eye(4))
    assert close(g.inverse(T) @ T, np.eye(4))
    assert close(g.inverse(g.inverse(T)), T)
    assert close(g.inverse(T), np.linalg.inv(T))


@given(poses, poses)
def test_inverse_of_a_product(A: np.ndarray, B: np.ndarray) -> None:
    assert close(g.inverse(A @ B), g.inverse(B) @ g.inverse(A), 1e-8)


@given(st.lists(poses, min_size=1, max_size=5))
def test_stacks_are_inverted_one_by_one(stack: list[np.ndarray]) -> None:
    assert close(g.inverse(np.array(stack)), np.array([g.inverse(T) for T in stack]))
    nested = np.array(stack)[:, None]
    assert g.inverse(nested).shape == nested.shape


@given(poses, poses, poses)
def test_between_cancels(M: np.ndarray, A: np.ndarray, B: np.ndarray) -> None:
    assert close(A @ g.between(A, B), B, 1e-8)
    assert close(g.between(M @ A, M @ B), g.between(A, B), 1e-7), "the common frame does not matter"
    assert close(g.between(A, A), np.eye(4))


@given(poses, poses, st.lists(vectors, min_size=1, max_size=6))
def test_transform_is_an_action(A: np.ndarray, B: np.ndarray, points: list[np.ndarray]) -> None:
    p = np.array(points)
    assert close(g.transform(A, g.transform(B, p)), g.transform(A @ B, p), 1e-8)
    assert close(g.transform(np.eye(4), p), p)
    q = g.transform(A, p)
    assert close(np.linalg.norm(q - q[0], axis=1), np.linalg.norm(p - p[0], axis=1), 1e-8)


@given(axes, angles)
def test_so3_exp_then_log(axis: np.ndarray, angle: float) -> None:
    R = g.so3_exp(axis * angle)
    back = g.so3_log(R)
    assert np.linalg.norm(back) <= np.pi + 1e-12
    assert close(g.so3_exp(back), R, 1e-12)
    if angle < np.pi - 1e-6:
        assert close(back, axis * angle, 1e-9)


@given(axes, st.floats(-12, -4))
def test_small_rotations_keep_their_relative_precision(axis: np.ndarray, exponent: float) -> None:
    v = axis * 10.0**exponent
    assert np.linalg.norm(g.so3_log(g.so3_exp(v)) - v) <= 1e-4 * np.linalg.norm(v) ** 2 + 1e-15
    back = g.se3_log(g.se3_exp(np.concatenate([v, v])))
    assert np.linalg.norm(back - np.concatenate([v, v])) <= 1e-4 * np.linalg.norm(v) ** 2 + 1e-15


@given(axes, angles)
def test_so3_exp_turns_about_its_axis(axis: np.ndarray, angle: float) -> None:
    R = g.so3_exp(axis * angle)
    assert close(R @ axis, axis, 1e-12)
    assert np.isclose(np.trace(R), 1 + 2 * np.cos(angle), atol=1e-12)
    assert close(g.so3_exp(-axis * angle), R.T, 1e-12)
    assert np.isclose(g.rotation_angle(g.make(R, np.zeros(3))), angle, atol=1e-9)


@given(axes, st.floats(0, 20), st.floats(0, 20))
def test_turns_about_one_axis_add_up(axis: np.ndarray, a: float, b: float) -> None:
    assert close(g.so3_exp(axis * a) @ g.so3_exp(axis * b), g.so3_exp(axis * (a + b)))


@given(tangents)
def test_se3_exp_then_log(tangent: np.ndarray) -> None:
    T = g.se3_exp(tangent)
    assert close(g.se3_exp(g.se3_log(T)), T, 1e-7)
    if np.linalg.norm(tangent[3:]) < np.pi - 1e-3:
        assert close(g.se3_log(T), tangent, 1e-6)


@given(poses)
def test_se3_log_then_exp(T: np.ndarray) -> None:
    assert close(g.se3_exp(g.se3_log(T)), T, 1e-7)


@given(vectors)
def test_se3_without_rotation_is_a_shift(shift: np.ndarray) -> None:
    tangent = np.concatenate([shift, np.zeros(3)])
    assert close(g.se3_exp(tangent), g.make(np.eye(3), shift))
    assert close(g.se3_log(g.make(np.eye(3), shift)), tangent)


@given(tangents)
def test_se3_exp_is_the_matrix_exponential(tangent: np.ndarray) -> None:
    X = np.zeros((4, 4))
    X[:3, :3], X[:3, 3] = g.hat(tangent[3:]), tangent[:3]
    # Half the way 2^10 times smaller, then squared: a series of a few terms is exact.
    small, total, term = X / 1024, np.eye(4), np.eye(4)
    for k in range(1, 8):
        term = term @ small / k
        total = total + term
    for _ in range(10):
        total = total @ total
    assert close(g.se3_exp(tangent), total, 1e-8)


@given(poses, tangents)
def test_adjoint_moves_tangents_between_frames(T: np.ndarray, tangent: np.ndarray) -> None:
    assume(np.linalg.norm(tangent[3:]) < np.pi - 1e-3)
    left = T @ g.se3_exp(tangent) @ g.inverse(T)
    assert close(left, g.se3_exp(g.adjoint(T) @ tangent), 1e-5)


@given(poses, poses)
def test_adjoint_is_a_homomorphism(A: np.ndarray, B: np.ndarray) -> None:
    assert close(g.adjoint(A @ B), g.adjoint(A) @ g.adjoint(B), 1e-7)
    assert close(g.adjoint(g.inverse(A)), np.linalg.inv(g.adjoint(A)), 1e-6)


@given(rotations, vectors, st.floats(0.1, 10), st.booleans())
def test_quaternions_carry_rotations(R: np.ndarray, t: np.ndarray, length: float, other_sign: bool) -> None:
    quat = g.to_quat_xyzw(R)
    assert np.isclose(np.linalg.norm(quat), 1.0)
    assert quat[3] >= 0
    T = g.from_quat_xyzw((-length if other_sign else length) * quat, t)
    assert close(T, g.make(R, t), 1e-12)
    assert np.array_equal(g.to_quat_xyzw(T), g.to_quat_xyzw(T[:3, :3]))


@given(st.lists(poses, max_size=5))
def test_quaternions_of_many_are_those_of_each(stack: list[np.ndarray]) -> None:
    found = g.to_quats_xyzw(np.array(stack).reshape(-1, 4, 4))
    assert close(found, np.array([g.to_quat_xyzw(T) for T in stack]).reshape(-1, 4), 1e-15)


@given(axes, angles)
def test_quaternions_have_half_the_angle(axis: np.ndarray, angle: float) -> None:
    x, y, z, w = g.to_quat_xyzw(g.so3_exp(axis * angle))
    found = np.array([x, y, z, w])
    expected = np.concatenate([np.sin(angle / 2) * axis, [np.cos(angle / 2)]])
    assert min(np.linalg.norm(found - expected), np.linalg.norm(found + expected)) < 1e-9


@given(poses, poses, st.floats(0, 1))
def test_interpolation_goes_evenly_from_end_to_end(A: np.ndarray, B: np.ndarray, fraction: float) -> None:
    assume(g.rotation_angle(g.between(A, B)) < np.pi - 1e-3)
    assert close(g.interpolate(A, B, 0.0), A, 1e-7)
    assert close(g.interpolate(A, B, 1.0), B, 1e-6)
    C = g.interpolate(A, B, fraction)
    assert np.isclose(g.rotation_angle(g.between(A, C)), fraction * g.rotation_angle(g.between(A, B)), atol=1e-7)
    assert close(g.interpolate(B, A, 1 - fraction), C, 1e-5)


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_euler_angles_come_back(roll: float, pitch: float, yaw: float) -> None:
    R = g.so3_exp(np.array([0, 0, yaw])) @ g.so3_exp(np.array([0, pitch, 0])) @ g.so3_exp(np.array([roll, 0, 0]))
    assert close(g.to_euler_rpy(R), np.array([roll, pitch, yaw]), 1e-8)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_half_turns_about_every_axis(sign: float) -> None:
    for axis in np.vstack([np.eye(3), np.ones((1, 3)) / np.sqrt(3)]):
        R = g.so3_exp(sign * np.pi * axis)
        assert close(g.so3_exp(g.so3_log(R)), R, 1e-12)
        assert np.isclose(np.linalg.norm(g.so3_log(R)), np.pi)


@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6))
def test_flattened_is_planar_keeps_the_heading_and_changes_nothing_twice(tangent: list[float]) -> None:
    T = g.se3_exp(np.array(tangent))
    flat = g.flattened(T)
    np.testing.assert_allclose(g.flattened(flat), flat, atol=1e-15)
    np.testing.assert_array_equal(flat[2], [0, 0, 1, 0])
    np.testing.assert_array_equal(flat[:2, 3], T[:2, 3])
    np.testing.assert_allclose(flat[:3, :3] @ flat[:3, :3].T, np.eye(3), atol=1e-12)
    if np.hypot(T[0, 0], T[1, 0]) > 1e-3:
        difference = g.to_euler_rpy(flat)[2] - g.to_euler_rpy(T)[2]
        np.testing.assert_allclose(np.exp(1j * difference), 1.0, atol=1e-9)


@given(st.floats(-3, 3), st.floats(-9, 9), st.floats(-9, 9), st.floats(-3, 3))
def test_planar_motions_stay_themselves_and_compose(yaw: float, x: float, y: float, turn: float) -> None:
    a = g.make(g.so3_exp(np.array([0.0, 0.0, yaw])), np.array([x, y, 0.0]))
    b = g.make(g.so3_exp(np.array([0.0, 0.0, turn])), np.array([y, -x, 0.0]))
    np.testing.assert_allclose(g.flattened(a), a, atol=1e-12)
    np.testing.assert_allclose(g.flattened(a @ b), g.flattened(a) @ g.flattened(b), atol=1e-9)
