"""What odometry says of the robot's motion since the last node of the map."""

from __future__ import annotations

import numpy as np

from slam.geometry import between
from slam.memory.speed import Speed
from slam.params import Params
from slam.types import UNKNOWN_VARIANCE, Frame, Link, LinkType, Node, Odometry

#: Stamps of a 30 Hz camera jitter by less than this share of the time between two updates.
_JITTER = 0.05


class Motion:
    """Gathers the covariance of the frames between two nodes, and says when the next map update is due.

    Attributes:
        surest: (6,) largest information that a link between neighbours had on each axis.
        travelled_m: length of the way over all nodes.
    """

    def __init__(self) -> None:
        self.surest = np.zeros(6)
        self.travelled_m = 0.0
        self.covariance = np.zeros((6, 6))
        self._last_stamp = -np.inf
        self._speed, self._too_fast = Speed(), False

    @property
    def restarted(self) -> bool:
        """Whether odometry began anew since the last node."""
        return bool(self.covariance[0, 0] >= UNKNOWN_VARIANCE)

    @property
    def goes_on(self) -> bool:
        """Whether odometry leads from the last node to this frame, at a speed that it may be kept at."""
        return not (self.restarted or self._too_fast)

    def collect(self, frame: Frame, odometry: Odometry, params: Params) -> None:
        """Keeps the largest covariance since the last node: frames share the local map, so errors don't add up."""
        if odometry.T_odom_base is not None and odometry.covariance[0, 0] > self.covariance[0, 0]:
            self.covariance = odometry.covariance
        self._too_fast = self._speed.exceeds(frame.stamp, odometry.T_odom_base, params)

    def due(self, frame: Frame, odometry: Odometry, params: Params) -> bool:
        """Whether a map update is due for this frame (``Rtabmap/DetectionRate``, by the frames' stamps)."""
        if odometry.T_odom_base is None or self._too_fast:
            return False
        rate = params.Rtabmap.DetectionRate
        if rate == 0 or self.restarted:
            return True
        # A camera's clock may be set back; waiting until it has caught up would stop the map.
        return not 0.0 <= frame.stamp - self._last_stamp < (1.0 - _JITTER) / rate

    def updated(self, frame: Frame) -> None:
        """A map update begins with this frame."""
        self._last_stamp = frame.stamp

    def link(self, last: Node, node: Node) -> Link:
        """The link of a node to the one before it in the same session."""
        T_last_node = between(last.T_odom_base, node.T_odom_base)
        self.travelled_m += float(np.linalg.norm(T_last_node[:3, 3]))
        information = np.asarray(np.linalg.inv(self.covariance), np.float64)
        self.surest = np.maximum(self.surest, np.diagonal(information))
        return Link(node.id, last.id, LinkType.NEIGHBOR, between(node.T_odom_base, last.T_odom_base), information)

    def begin(self) -> None:
        """A node was made: what follows is the motion from there."""
        self.covariance = np.zeros((6, 6))
