"""Odometry of frames that are replayed from a map file: what is stored, or our own on the stored images."""

from __future__ import annotations

import time

import numpy as np

from slam.features.prepared import PreparedExtractor
from slam.features.words import nothing_seen
from slam.geometry import Array, Pose
from slam.odometry.strategy import Tracker, make_tracker
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Features, Frame, Odometry, Refusal


class StoredOdometry:
    """Gives each frame the pose and covariance that its file has of it."""

    def __init__(self) -> None:
        self._extractor = PreparedExtractor()

    def prepare(self, frame: Frame, params: Params) -> None:
        """Extracts the features of a frame that has none stored; from another thread."""
        if _seen(frame) is None:
            self._extractor.prepare(frame, params)

    def track(self, frame: Frame, params: Params) -> Odometry:
        """The stored pose; lost where there is none."""
        start, features = time.perf_counter(), _seen(frame)
        features = self._extractor.extract(frame, params).features if features is None else features
        stored = frame.stored
        if stored is None or stored.T_odom_base is None:
            return _lost(features, "odometry", "the map file has no odometry pose of this node", start)
        return _odometry(stored.T_odom_base, stored.covariance, features, None, start)


class OwnOdometry:
    """Tracks the stored images by ``Odom/Strategy``, anew in each session of the file."""

    def __init__(self, params: Params) -> None:
        self._tracker: Tracker = make_tracker(params)

    def prepare(self, frame: Frame, params: Params) -> None:
        """Prepares a frame that is tracked soon; from another thread."""
        if frame.image_bgr.size:
            self._tracker.prepare(frame, params)

    def track(self, frame: Frame, params: Params) -> Odometry:
        """The tracker's answer; lost where the file has no image."""
        if not frame.image_bgr.size:
            text = "the map file has no image of this node: replay it with the odometry that is stored"
            return _lost(nothing_seen(), "image", text, time.perf_counter())
        if frame.stored is not None and frame.stored.covariance[0, 0] >= UNKNOWN_VARIANCE:
            self._tracker = make_tracker(params)
        return self._tracker.track(frame, params)


def _seen(frame: Frame) -> Features | None:
    return None if frame.stored is None else frame.stored.features


def _lost(features: Features, test: str, text: str, start: float) -> Odometry:
    return _odometry(None, np.eye(6) * UNKNOWN_VARIANCE, features, Refusal(test, 0.0, 1.0, text), start)


def _odometry(T: Pose | None, covariance: Array, features: Features, lost: Refusal | None, start: float) -> Odometry:
    time_ms = (time.perf_counter() - start) * 1e3
    return Odometry(T, covariance, features, 0, 0, T is not None, lost, time_ms)
