"""The walk: a smooth closed round, a hand's breadth aside each lap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, make
from slam.sensors.tour.options import TourOptions

Array = NDArray[np.float64]

EYE_HEIGHT_M = 1.2
#: Corners of the round in metres, before they are rounded.
_CORNERS = np.array(
    [[1.0, 0.85], [6.5, 1.45], [12.95, 0.9], [12.4, 4.8], [12.9, 8.9], [7.3, 8.4], [1.1, 9.0], [1.75, 5.0]]
)
#: Rounding; a right angle becomes a turn of at most 1.13 / this radians per metre.
_SMOOTHING_M = 2.4
_STEP_M = 0.01
#: How far a lap lies beside the one before, least and most, and all laps together at most.
_ASIDE_M = (0.08, 0.12)
_ASIDE_ALL_M = 0.5
#: The walker looks where he will be in this time.
_LOOK_AHEAD_S = 0.4
#: Turned a little to the left, to the middle of the flat.
_GLANCE_RAD = 0.12


class Walk:
    """Poses of the walk by time in seconds; the same seed walks the same way."""

    def __init__(self, options: TourOptions) -> None:
        rng = np.random.default_rng([options.seed, 1])
        self._round = _smooth_round()
        following = np.roll(self._round, -1, axis=0) - np.roll(self._round, 1, axis=0)
        following /= np.linalg.norm(following, axis=1, keepdims=True)
        self._left = np.column_stack([-following[:, 1], following[:, 0]])
        self._speed, self._laps = options.speed, options.laps
        self._aside = min(float(rng.uniform(*_ASIDE_M)), _ASIDE_ALL_M / options.laps)
        self._phases = rng.uniform(0, 2 * np.pi, 8)

    @property
    def lap_m(self) -> float:
        """Length of one lap in metres."""
        return len(self._round) * _STEP_M

    def T_world_base(self, time_s: float) -> Pose:
        """Pose of the base (x forward, y left, z up) at a time since the start."""
        here, ahead = self._position(time_s), self._position(time_s + _LOOK_AHEAD_S)
        sway = self._sway
        heading = float(np.arctan2(ahead[1] - here[1], ahead[0] - here[0]))
        yaw = heading + _GLANCE_RAD + 0.10 * sway(0, 0.05, time_s) + 0.02 * sway(1, 0.21, time_s)
        pitch = 0.05 + 0.020 * sway(2, 0.17, time_s) + 0.006 * sway(3, 0.9, time_s)
        roll = 0.015 * sway(4, 0.13, time_s) + 0.008 * sway(5, 0.45, time_s)
        height = EYE_HEIGHT_M + 0.012 * sway(6, 0.9, time_s) + 0.02 * sway(7, 0.11, time_s)
        return make(_rotation(yaw, pitch, roll), np.array([here[0], here[1], height]))

    def _sway(self, phase: int, hertz: float, time_s: float) -> float:
        return float(np.sin(2 * np.pi * hertz * time_s + self._phases[phase]))

    def _position(self, time_s: float) -> Array:
        laps = self._speed * time_s / self.lap_m
        along = laps * len(self._round)
        low = int(np.floor(along))
        a, b, f = low % len(self._round), (low + 1) % len(self._round), along - low
        left = (1 - f) * self._left[a] + f * self._left[b]
        aside = (laps - self._laps / 2) * self._aside
        return np.asarray((1 - f) * self._round[a] + f * self._round[b] + aside * left)


def _smooth_round() -> Array:
    """The corners as a closed line of equal steps, rounded by a circular Gaussian along its length."""
    line = _resample(_CORNERS)
    frequency = np.fft.fftfreq(len(line), _STEP_M)
    gain = np.exp(-2.0 * (np.pi * _SMOOTHING_M * frequency) ** 2)
    smooth = np.fft.ifft(np.fft.fft(line[:, 0] + 1j * line[:, 1]) * gain)
    return _resample(np.column_stack([smooth.real, smooth.imag]))


def _resample(corners: Array) -> Array:
    closed = np.vstack([corners, corners[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    count = round(length[-1] / _STEP_M)
    at = np.arange(count) * (length[-1] / count)
    return np.column_stack([np.interp(at, length, closed[:, 0]), np.interp(at, length, closed[:, 1])])


def _rotation(yaw: float, pitch: float, roll: float) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll); positive pitch looks down."""
    cy, sy, cp, sp, cr, sr = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
