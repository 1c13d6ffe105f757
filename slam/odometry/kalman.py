"""A Kalman filter over the camera's velocity, which makes the reported path smoother than what was tracked."""

from __future__ import annotations

import numpy as np

from slam.geometry import Array, Pose, between, se3_exp, se3_log
from slam.params import Params


class VelocityFilter:
    """Velocity and acceleration of each of the six axes, driven by white noise (Bar-Shalom et al. 2001, section 6.2).

    The reported pose never drifts from the tracked one: each step measures the way from what was reported last.
    """

    def __init__(self) -> None:
        self._T_odom_base: Pose | None = None
        self._stamp = 0.0
        self._state = np.zeros((2, 6))
        self._covariance = np.eye(2)

    def smooth(self, T_odom_base: Pose, stamp: float, params: Params) -> Pose:
        """The pose to report of a tracked pose; the same where ``Odom/FilteringStrategy`` is 0."""
        last, interval_s = self._T_odom_base, stamp - self._stamp
        self._stamp = stamp
        if last is None or params.Odom.FilteringStrategy == 0 or interval_s <= 0:
            self._T_odom_base = T_odom_base
            return T_odom_base
        twist = self._filtered(se3_log(between(last, T_odom_base)) / interval_s, interval_s, params)
        self._T_odom_base = np.asarray(last @ se3_exp(twist * interval_s))
        return self._T_odom_base

    def restart(self) -> None:
        """Tracking was lost: the motion over the gap is no velocity."""
        self._T_odom_base = None
        self._state = np.zeros((2, 6))
        self._covariance = np.eye(2)

    def _filtered(self, measured: Array, interval_s: float, params: Params) -> Array:
        F = np.array([[1.0, interval_s], [0.0, 1.0]])
        predicted = F @ self._state
        P = F @ self._covariance @ F.T + np.eye(2) * params.Odom.KalmanProcessNoise
        gain = P[:, :1] / (P[0, 0] + params.Odom.KalmanMeasurementNoise)
        self._state = predicted + gain @ (measured - predicted[0])[None]
        self._covariance = P - gain @ P[:1]
        return np.asarray(self._state[0], np.float64)
