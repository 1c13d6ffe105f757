"""Places of the map and the memory they live in."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose
from slam.types.features import Features
from slam.types.frame import Images, Scan

#: Weight of a node that was merged or discarded, and of one that is only part of the graph.
WEIGHT_INVALID = -9
WEIGHT_INTERMEDIATE = -1


class Tier(StrEnum):
    """The memory a node lives in."""

    STM = "stm"
    WM = "wm"
    LTM = "ltm"


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """A place of the map: what memory keeps of it in RAM.

    Attributes:
        id: positive, ascending in time.
        map_id: session number.
        weight: 0 and up; -1 intermediate, -9 invalid.
        stamp: seconds.
        T_odom_base: (4, 4) odometry pose.
        features: up to Vis/MaxFeatures key points, best first.
        word_ids: (N,) int32; > 0 is a word of the dictionary, < 0 a key point that was not quantised.
        camera: the camera that saw it.
        T_world_base: ground truth where known.
        scan: its cloud, where ``Reg/Strategy`` asks for ICP.
        images: its images, where ``Vis/CorType`` asks for optical flow.
    """

    id: int
    map_id: int
    weight: int
    stamp: float
    T_odom_base: Pose
    features: Features
    word_ids: NDArray[np.int32]
    camera: Camera
    T_world_base: Pose | None = None
    scan: Scan | None = None
    images: Images | None = None
