"""What the sensors deliver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose

if TYPE_CHECKING:
    from slam.types.stored import Stored


@dataclass(frozen=True, slots=True, eq=False)
class ExternalOdometry:
    """Where somebody else's odometry has the base.

    Attributes:
        T_odom_base: (4, 4) in a frame of its own.
        variances: (2,) linear (m^2) and angular (rad^2), of all the motion since its start.
    """

    T_odom_base: Pose
    variances: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One synchronised colour and depth image, rectified.

    Attributes:
        index: running number in its source, from 0.
        stamp: acquisition time of the colour image in seconds.
        image_bgr: (H, W, 3) uint8; of no pixels where a replayed node has no image any more.
        depth_m: (H, W) float32 depth along the optical axis in metres, 0 where unknown; likewise.
        camera: the camera of both images.
        T_world_base: ground truth, where known.
        T_gravity_base: attitude of the base with respect to gravity (rotation only), where an accelerometer tells.
        depth_delay_s: acquisition time of the depth image minus ``stamp``.
        external: odometry from outside, where there is any.
        stored: what a map file has of it, where one is replayed.
    """

    index: int
    stamp: float
    image_bgr: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
    camera: Camera
    T_world_base: Pose | None = None
    T_gravity_base: Pose | None = None
    depth_delay_s: float = 0.0
    external: ExternalOdometry | None = None
    stored: Stored | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Scan:
    """Points of one place for ICP, from a depth image or a laser.

    Attributes:
        points_base: (N, 3) float32 in the base frame, metres, all finite.
        normals_base: (N, 3) float32 unit normals; None when they were not computed.
        most: points that one look can have, where that is fewer than N: what a merged scan is measured by; 0 for N.
    """

    points_base: NDArray[np.float32]
    normals_base: NDArray[np.float32] | None = None
    most: int = 0

    def __len__(self) -> int:
        return len(self.points_base)


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """What optical flow needs of a frame: (H, W) uint8 gray, and (H, W) float32 depth in metres, 0 where unknown."""

    gray: NDArray[np.uint8]
    depth_m: NDArray[np.float32]
