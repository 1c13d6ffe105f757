"""What a map file has of a frame that is mapped again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose
from slam.types.features import Descriptors, Features
from slam.types.frame import Scan
from slam.types.grid import LocalGrid
from slam.types.link import Link


@dataclass(frozen=True, slots=True, eq=False)
class Stored:
    """What the node of a replayed frame takes over from the file it was in.

    Attributes:
        T_odom_base: its pose in the odometry frame, None where it is not known.
        covariance: (6, 6) of the motion since the node before; 9999 on the diagonal where a session begins.
        features: its key points, those that were words first; None to find them in the image anew.
        words: how many of them were words.
        word_ids: (words,) int32 those words, to be kept; None to look for words anew.
        word_descriptors: (W, B) of the distinct ones among them, ascending.
        constraints: its prior, gravity and sightings of landmarks; ``from_id`` is the id it had in that file.
        scan: its cloud.
        grid: its local grid, for where no depth image is left to make it of.
        node: columns of the table Node that the engine does not make, as they are.
        data: columns of the table Data likewise; those that the engine makes anew replace them.
    """

    T_odom_base: Pose | None
    covariance: NDArray[np.float64]
    features: Features | None = None
    words: int = 0
    word_ids: NDArray[np.int32] | None = None
    word_descriptors: Descriptors | None = None
    constraints: tuple[Link, ...] = ()
    scan: Scan | None = None
    grid: LocalGrid | None = None
    node: Mapping[str, object] = field(default_factory=dict)
    data: Mapping[str, object] = field(default_factory=dict)
