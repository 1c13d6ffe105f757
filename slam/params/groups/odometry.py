"""Parameters of odometry."""

from __future__ import annotations

from slam.params.registry import Effect, Group, param

_SESSION = Effect.SESSION


class OdomGroup(Group):
    """Odometry."""

    Strategy: int = param(0, "Track against 0 a local map, 1 the last key frame.", ge=0, le=1, effect=_SESSION)
    External: int = param(
        0, "Odometry of the source: 0 not used, 1 the guess of visual odometry, 2 alone.", ge=0, le=2, effect=_SESSION
    )
    FilteringStrategy: int = param(0, "Smooth the path: 0 not at all, 1 by a Kalman filter.", ge=0, le=1)
    KalmanProcessNoise: float = param(0.001, "Variance that the velocity gains per frame.", ge=1e-9)
    KalmanMeasurementNoise: float = param(0.01, "Variance of a measured velocity.", ge=1e-9)
    GuessMotion: bool = param(True, "Predict the next pose with constant velocity.")
    ResetCountdown: int = param(
        0, "Lost frames after which odometry starts anew, as a new session; 0 waits.", unit="frames", ge=0
    )
    ReadoutTime: float = param(
        -1.0,
        "Time between the first and the last row of a colour image; 0 is a global shutter, below 0 it is estimated.",
        unit="ms",
        ge=-1,
        le=50,
    )
    KeyFrameThr: float = param(0.3, "New key frame when inliers fall below this share of features.", ge=0, le=1)
    VisKeyFrameThr: int = param(150, "New key frame when inliers fall below this number.", unit="inliers", ge=0)


class OdomF2MGroup(Group):
    """Frame-to-map odometry."""

    MaxSize: int = param(2000, "Points in the local map.", unit="points", ge=100)
    BundleAdjustment: int = param(
        1,
        "Adjust the points of the local map to the key frames that see them, whose poses are held: 0 off, 1 on.",
        ge=0,
        le=1,
    )
    BundleAdjustmentMaxFrames: int = param(
        10, "Key frames that a point is adjusted to; what older ones saw of it fades.", unit="frames", ge=2, le=50
    )
