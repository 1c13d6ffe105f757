"""The walk: a smooth closed round, a little different each lap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, make
from slam.sensors.tour.options import TourOptions

Array = NDArray[np.float64]

EYE_HEIGHT = 1.2
#: Corners of the round in metres; they are rounded by ``_SMOOTHING_M``.
_CORNERS = np.array(
    [[2.0, 1.3], [6.5, 1.45], [12.1, 1.25], [12.5, 4.6], [12.2, 8.2], [7.5, 8.5], [1.7, 8.3], [1.5, 5.0]]
)
_SMOOTHING_M = 0.85
_STEP_M = 0.01
#: A lap's offset from the mean round, alternately left and right.
_OFFSET_M = (0.03, 0.07)
_BLEND_M = 3.0


class Walk:
    """Poses of the walk by time in seconds; the same seed walks the same way."""

    def __init__(self, options: TourOptions) -> None:
        rng = np.random.default_rng([options.seed, 1])
        self._round = _smooth_round()
        self._speed = options.speed
        sides = np.where(np.arange(options.laps + 1) % 2 == 0, 1.0, -1.0)
        self._offsets = sides * rng.uniform(*_OFFSET_M, options.laps + 1)
        self._phases = rng.uniform(0, 2 * np.pi, 8)

    @property
    def lap_m(self) -> float:
        """Length of one lap in metres."""
        return len(self._round) * _STEP_M

    def T_world_base(self, time_s: float) -> Pose:
        """Pose of the base (x forward, y left, z up) at a time since the start."""
        here, ahead = self._position(time_s), self._position(time_s + 0.25)
        heading = float(np.arctan2(ahead[1] - here[1], ahead[0] - here[0]))
        sway = self._sway
        yaw = heading + 0.10 * sway(0, 0.07, time_s) + 0.03 * sway(1, 0.21, time_s)
        pitch = 0.05 + 0.020 * sway(2, 0.17, time_s) + 0.006 * sway(3, 0.9, time_s)
        roll = 0.015 * sway(4, 0.13, time_s) + 0.008 * sway(5, 0.45, time_s)
        height = EYE_HEIGHT + 0.012 * sway(6, 0.9, time_s) + 0.02 * sway(7, 0.11, time_s)
        return make(_rotation(yaw, pitch, roll), np.array([here[0], here[1], height]))

    def _sway(self, phase: int, hertz: float, time_s: float) -> float:
        return float(np.sin(2 * np.pi * hertz * time_s + self._phases[phase]))

    def _position(self, time_s: float) -> Array:
        way = self._speed * time_s
        along = way / _STEP_M
        count = len(self._round)
        low = int(np.floor(along))
        a, b = self._round[low % count], self._round[(low + 1) % count]
        tangent = (b - a) / np.linalg.norm(b - a)
        aside = np.array([-tangent[1], tangent[0]]) * self._offset(way)
        return np.asarray(a + (along - low) * (b - a) + aside)

    def _offset(self, way: float) -> float:
        lap = min(int(way // self.lap_m), len(self._offsets) - 1)
        last = self._offsets[max(lap - 1, 0)]
        x = min((way - lap * self.lap_m) / _BLEND_M, 1.0)
        return float(last + (self._offsets[lap] - last) * x * x * x * (x * (6 * x - 15) + 10))


def _smooth_round() -> Array:
    """The corners as a closed line of equal steps, rounded by a circular Gaussian along its length."""
    line = _resample(_CORNERS)
    frequency = np.fft.fftfreq(len(line), _STEP_M)
    gain = np.exp(-2.0 * (np.pi * _SMOOTHING_M * frequency) ** 2)
    spectrum = np.fft.fft(line[:, 0] + 1j * line[:, 1]) * gain
    smooth = np.fft.ifft(spectrum)
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
