"""Constraints between nodes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose

#: Variance that means "do not use", as in RTAB-Map.
UNKNOWN_VARIANCE = 9999.0


class LinkType(IntEnum):
    """RTAB-Map's link types, by their number in the database."""

    NEIGHBOR = 0
    GLOBAL_CLOSURE = 1
    LOCAL_SPACE_CLOSURE = 2
    LOCAL_TIME_CLOSURE = 3
    USER_CLOSURE = 4
    VIRTUAL_CLOSURE = 5
    NEIGHBOR_MERGED = 6
    POSE_PRIOR = 7
    LANDMARK = 8
    GRAVITY = 9

    @property
    def label(self) -> str:
        """Name as RTAB-Map prints it, for example ``GlobalClosure``."""
        return "".join(part.capitalize() for part in self.name.split("_"))

    @property
    def is_loop(self) -> bool:
        """Whether it joins two places beyond odometry."""
        return LinkType.GLOBAL_CLOSURE <= self <= LinkType.USER_CLOSURE


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A constraint: pose(to) = pose(from) @ T_from_to.

    Attributes:
        from_id: node id.
        to_id: node id; equal to from_id for priors and gravity; negative for landmarks.
        type: what it is.
        T_from_to: (4, 4), None for the marker of a merged node.
        information: (6, 6) inverse covariance, x y z roll pitch yaw.
    """

    from_id: int
    to_id: int
    type: LinkType
    T_from_to: Pose | None
    information: NDArray[np.float64]

    @property
    def pair(self) -> tuple[int, int]:
        """Both ids, smaller first."""
        a, b = self.from_id, self.to_id
        return (a, b) if a <= b else (b, a)
