"""Rigid motions SE(3) on plain arrays.

A pose is a (4, 4) float64 matrix ``T_a_b`` that takes points of frame b into frame a, so that composition reads
by cancelling: ``T_map_base = T_map_odom @ T_odom_base``. Quaternions are ordered x y z w. Tangent vectors are
ordered translation first (x y z, then the rotation vector), like every 6x6 matrix of slamdeck.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Pose = NDArray[np.float64]
Array = NDArray[np.float64]
_SMALL = 1e-8


def inverse(T_a_b: Pose) -> Pose:
    """``T_b_a`` of ``T_a_b``; also for stacks of shape (..., 4, 4)."""
    R_b_a = np.swapaxes(T_a_b[..., :3, :3], -1, -2)
    T_b_a = np.zeros_like(T_a_b)
    T_b_a[..., :3, :3] = R_b_a
    T_b_a[..., :3, 3] = -(R_b_a @ T_a_b[..., :3, 3:])[..., 0]
    T_b_a[..., 3, 3] = 1.0
    return T_b_a


def normalized(T_a_b: Pose) -> Pose:
    """The pose with its rotation made orthonormal again.

    ``inverse`` transposes, so that a pose predicted from earlier poses doubles any departure at each step.
    """
    return from_quat_xyzw(to_quat_xyzw(T_a_b), T_a_b[:3, 3])


def between(T_m_a: Pose, T_m_b: Pose) -> Pose:
    """``T_a_b`` of two poses in a common frame m."""
    return inverse(T_m_a) @ T_m_b


def transform(T_a_b: Pose, points_b: NDArray[np.floating]) -> Array:
    """Points (N, 3) of frame b, in frame a."""
    return np.asarray(points_b @ T_a_b[:3, :3].T + T_a_b[:3, 3], dtype=np.float64)


def make(R_a_b: Array, t_a_b: Array) -> Pose:
    """Pose from a rotation (3, 3) and a translation (3,) in metres."""
    T_a_b = np.eye(4)
    T_a_b[:3, :3] = R_a_b
    T_a_b[:3, 3] = np.ravel(t_a_b)
    return T_a_b


def hat(v: Array) -> Array:
    """(3, 3) matrix whose product with w is the cross product of v and w."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def so3_exp(rotation_vector: Array) -> Array:
    """Rotation (3, 3) of a rotation vector (3,) in radians (Rodrigues)."""
    angle = float(np.linalg.norm(rotation_vector))
    K = hat(rotation_vector)
    if angle < _SMALL:
        return np.eye(3) + K + 0.5 * (K @ K)
    a, b = np.sin(angle) / angle, _versine(angle)
    return np.asarray(np.eye(3) + a * K + b * (K @ K))


def _versine(angle: float) -> float:
    """(1 - cos x) / x^2 as half a square of sines: the difference would lose all digits of small angles."""
    return float(0.5 * (np.sin(0.5 * angle) / (0.5 * angle)) ** 2)


def so3_log(R: Array) -> Array:
    """Rotation vector (3,) in radians, of length in [0, pi], by way of the quaternion."""
    x, y, z, w = to_quat_xyzw(R)
    v = np.array([x, y, z])
    sine = float(np.linalg.norm(v))
    if sine < _SMALL:
        return 2.0 * v
    return np.asarray(2.0 * np.arctan2(sine, w) / sine * v)


def se3_exp(tangent: Array) -> Pose:
    """Pose of a tangent vector (6,): translation first, then rotation (Barfoot 2017, equations 7.85 and 7.86)."""
    rho, phi = tangent[:3], tangent[3:]
    angle = float(np.linalg.norm(phi))
    K = hat(phi)
    if angle < _SMALL:
        V = np.eye(3) + 0.5 * K
    else:
        V = np.eye(3) + _versine(angle) * K + (angle - np.sin(angle)) / angle**3 * (K @ K)
    return make(so3_exp(phi), V @ rho)


def se3_log(T_a_b: Pose) -> Array:
    """Tangent vector (6,) of a pose; the inverse of ``se3_exp`` for angles below pi."""
    phi = so3_log(T_a_b[:3, :3])
    angle = float(np.linalg.norm(phi))
    K = hat(phi)
    if angle < 1e-4:
        V_inverse = np.eye(3) - 0.5 * K + (K @ K) / 12.0
    else:
        half = 0.5 * angle
        V_inverse = np.eye(3) - 0.5 * K + (1.0 - half / np.tan(half)) / angle**2 * (K @ K)
    return np.concatenate([V_inverse @ T_a_b[:3, 3], phi])


def flat(T: Array) -> Array:
    """Poses (N, 4, 4) in the plane z = 0: x, y and yaw stay, height, roll and pitch are taken out."""
    heading = np.hypot(T[:, 0, 0], T[:, 1, 0])
    upright = heading > _SMALL
    length = np.where(upright, heading, 1.0)
    # Who looks straight up or down has no yaw: 0 is as good as any.
    cosine, sine = np.where(upright, T[:, 0, 0] / length, 1.0), np.where(upright, T[:, 1, 0] / length, 0.0)
    return planar(T[:, 0, 3], T[:, 1, 3], cosine, sine)


def flattened(T_a_b: Pose) -> Pose:
    """The same of one pose (``Reg/Force3DoF``)."""
    return np.asarray(flat(T_a_b[None])[0])


def planar(x: Array, y: Array, cosine: Array, sine: Array) -> Array:
    """Poses (N, 4, 4) from positions in the plane (metres) and the yaw's cosine and sine, each (N,)."""
    T = np.zeros((len(x), 4, 4))
    T[:, 0, 0], T[:, 0, 1], T[:, 0, 3] = cosine, -sine, x
    T[:, 1, 0], T[:, 1, 1], T[:, 1, 3] = sine, cosine, y
    T[:, 2, 2] = T[:, 3, 3] = 1.0
    return T


def interpolate(T_m_a: Pose, T_m_b: Pose, fraction: float) -> Pose:
    """Pose on the screw motion from a (fraction 0) to b (fraction 1)."""
    return np.asarray(T_m_a @ se3_exp(fraction * se3_log(between(T_m_a, T_m_b))))


def rotation_angle(T_a_b: Pose) -> float:
    """Angle in radians, in [0, pi], of the rotation part."""
    return float(np.linalg.norm(so3_log(T_a_b[:3, :3])))


def translation_norm(T_a_b: Pose) -> float:
    """Length in metres of the translation part."""
    return float(np.linalg.norm(T_a_b[:3, 3]))


def adjoint(T_a_b: Pose) -> Array:
    """(6, 6) map of tangent vectors of frame b to frame a, translation first (Barfoot 2017, equation 7.43).

    Also for stacks of shape (..., 4, 4).
    """
    R, t = T_a_b[..., :3, :3], T_a_b[..., :3, 3]
    cross = np.zeros_like(R)
    cross[..., 0, 1], cross[..., 0, 2], cross[..., 1, 2] = -t[..., 2], t[..., 1], -t[..., 0]
    cross -= np.swapaxes(cross, -1, -2)
    Ad = np.zeros((*R.shape[:-2], 6, 6))
    Ad[..., :3, :3] = R
    Ad[..., 3:, 3:] = R
    Ad[..., :3, 3:] = cross @ R
    return Ad


def from_quat_xyzw(quat_xyzw: Array, t_a_b: Array) -> Pose:
    """Pose from a quaternion x y z w (normalised here) and a translation (3,) in metres."""
    x, y, z, w = np.asarray(quat_xyzw, dtype=np.float64) / np.linalg.norm(quat_xyzw)
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return make(R, np.asarray(t_a_b, dtype=np.float64))


def to_quat_xyzw(R: Array) -> Array:
    """Unit quaternion x y z w, with w >= 0, of a rotation (3, 3) or a pose (4, 4) (Shepperd's method)."""
    R = R[:3, :3]
    trace = float(np.trace(R))
    diagonal = (R[0, 0], R[1, 1], R[2, 2])
    if trace > max(diagonal):
        quat = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 1.0 + trace])
    else:
        i = int(np.argmax(diagonal))
        j, k = (i + 1) % 3, (i + 2) % 3
        quat = np.zeros(4)
        quat[i] = 1.0 + R[i, i] - R[j, j] - R[k, k]
        quat[j] = R[j, i] + R[i, j]
        quat[k] = R[k, i] + R[i, k]
        quat[3] = R[k, j] - R[j, k]
    quat = quat / np.linalg.norm(quat)
    return np.asarray(-quat if quat[3] < 0 else quat)


def to_quats_xyzw(T_a_b: Array) -> Array:
    """The same (N, 4) of many poses (N, 4, 4)."""
    R = T_a_b[:, :3, :3]
    diagonal, trace = np.diagonal(R, axis1=1, axis2=2), np.trace(R, axis1=1, axis2=2)
    # 4 q qT: each of its rows is q times a factor, that of the largest component the safest.
    products = np.empty((len(R), 4, 4))
    products[:, :3, :3] = R + np.swapaxes(R, 1, 2)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        products[:, i, i] = 1.0 + R[:, i, i] - R[:, j, j] - R[:, k, k]
        products[:, 3, i] = products[:, i, 3] = R[:, k, j] - R[:, j, k]
    products[:, 3, 3] = 1.0 + trace
    largest = np.where(trace > diagonal.max(axis=1), 3, diagonal.argmax(axis=1))
    quats = products[np.arange(len(R)), largest]
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    return np.asarray(np.where(quats[:, 3:] < 0.0, -quats, quats))


def from_euler_rpy(rpy: Array, t_a_b: Array) -> Pose:
    """Pose from roll, pitch, yaw (3,) in radians, R = Rz(yaw) Ry(pitch) Rx(roll), and a translation (3,) in metres."""
    roll, pitch, yaw = (so3_exp(angle * axis) for angle, axis in zip(rpy, np.eye(3), strict=True))
    return make(yaw @ pitch @ roll, np.asarray(t_a_b, dtype=np.float64))


def to_euler_rpy(R: Array) -> Array:
    """Roll, pitch, yaw in radians (R = Rz(yaw) Ry(pitch) Rx(roll)) of a rotation (3, 3) or a pose (4, 4)."""
    roll = np.arctan2(R[2, 1], R[2, 2])
    pitch = np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2]))
    yaw = np.arctan2(R[1, 0], R[0, 0])
    return np.array([roll, pitch, yaw])
