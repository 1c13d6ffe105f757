"""What tracking comes to, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types.features import Features
from slam.types.refusal import Refusal


@dataclass(frozen=True, slots=True, eq=False)
class Odometry:
    """Result of tracking one frame.

    Attributes:
        T_odom_base: (4, 4) pose, None when tracking was lost.
        covariance: (6, 6) of the motion since the last tracked frame; 9999 on the diagonal after a (re)start.
        features: what was seen in this frame.
        matches: number of features matched with the local map.
        inliers: number of those that agree with the pose.
        keyframe: whether the local map took in this frame.
        lost: reason, value and threshold when tracking was lost.
        time_ms: time this took.
    """

    T_odom_base: Pose | None
    covariance: NDArray[np.float64]
    features: Features
    matches: int
    inliers: int
    keyframe: bool
    lost: Refusal | None
    time_ms: float


@dataclass(frozen=True, slots=True, eq=False)
class TrackedFrame:
    """One frame of the trajectory: its pose hangs on the last node before it.

    Attributes:
        index: number in the source.
        stamp: seconds.
        node_id: the node it hangs on, 0 before the first.
        T_node_base: (4, 4) pose in that node's base frame; None when tracking was lost.
        T_world_base: ground truth where known.
        inliers: of the odometry.
        odometry_ms: time the odometry took.
        lost: text of the reason, empty when tracked.
        covariance: (6, 6) of its pose in axes of the map when localising in a finished one; 9999 while not recognised.
    """

    index: int
    stamp: float
    node_id: int
    T_node_base: Pose | None
    T_world_base: Pose | None
    inliers: int
    odometry_ms: float
    lost: str = ""
    covariance: NDArray[np.float64] | None = None
