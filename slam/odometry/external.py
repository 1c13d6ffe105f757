"""Odometry that somebody else computed: wheels, another tracker."""

from __future__ import annotations

import time

import numpy as np

from slam.features.prepared import PreparedExtractor
from slam.geometry import Array, Pose
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, ExternalOdometry, Features, Frame, Odometry, Refusal

_VARIANCE_FLOOR = 1e-8


class External:
    """Takes each frame's external pose as it is (``Odom/External`` 2); images serve loop closures only."""

    def __init__(self) -> None:
        self._extractor = PreparedExtractor()
        self._last: ExternalOdometry | None = None

    def prepare(self, frame: Frame, params: Params) -> None:
        """Extracts the features of a frame that is tracked soon; from another thread."""
        self._extractor.prepare(frame, params)

    def track(self, frame: Frame, params: Params) -> Odometry:
        """The external pose, with the covariance of the motion since the last one; lost where there is none."""
        found = self._extractor.extract(frame, params)
        start, features = time.perf_counter() - found.time_ms * 1e-3, found.features
        given, last = frame.external, self._last
        if given is None:
            text = "no external odometry at this stamp: Odom/External 2 needs odometry.txt or wheels.txt"
            refusal = Refusal("Odom/External", 0.0, 1.0, text)
            return self._result(None, np.eye(6) * UNKNOWN_VARIANCE, features, refusal, start)
        self._last = given
        covariance = np.eye(6) * UNKNOWN_VARIANCE
        if last is not None:
            linear, angular = np.maximum(given.variances - last.variances, _VARIANCE_FLOOR)
            covariance = np.diag([linear] * 3 + [angular] * 3)
        return self._result(given.T_odom_base, covariance, features, None, start)

    def _result(
        self, T_odom_base: Pose | None, covariance: Array, features: Features, lost: Refusal | None, start: float
    ) -> Odometry:
        time_ms = (time.perf_counter() - start) * 1e3
        return Odometry(T_odom_base, covariance, features, 0, 0, T_odom_base is not None, lost, time_ms)
