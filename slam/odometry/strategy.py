"""Which odometry tracks the frames."""

from __future__ import annotations

from typing import Protocol

from slam.odometry.external import External
from slam.odometry.frame_to_map import FrameToMap
from slam.odometry.local_map import LocalMap
from slam.params import Params
from slam.types import Frame, Odometry

#: ``Odom/External``: 0 not used, 1 as the guess of visual odometry, 2 alone.
_ALONE = 2


class Tracker(Protocol):
    """Gives each frame a pose in the odometry frame."""

    def prepare(self, frame: Frame, params: Params) -> None:
        """May be called, from another thread, with a frame that is tracked soon."""
        ...

    def track(self, frame: Frame, params: Params) -> Odometry:
        """Pose of a frame, or why there is none."""
        ...


def make_tracker(params: Params) -> Tracker:
    """By ``Odom/External`` and ``Odom/Strategy``: 0 against a local map, 1 against the last key frame."""
    if params.Odom.External == _ALONE:
        return External()
    return FrameToMap(LocalMap(last_only=params.Odom.Strategy == 1))
