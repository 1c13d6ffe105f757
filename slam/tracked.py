"""The frames tracked so far; each hangs on a node, and waits to be stored."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.geometry import Pose, between
from slam.types import Frame, Node, Odometry, TrackedFrame


class TrackedFrames:
    """Every frame of the map, in order.

    Attributes:
        frames: those of earlier sessions first.
    """

    def __init__(self, frames: list[TrackedFrame]) -> None:
        self.frames = frames
        self._unwritten: list[TrackedFrame] = []
        # Rows of the frames of this session, by the node that they hang on.
        self._rows: defaultdict[int, list[int]] = defaultdict(list)

    def hang(self, frame: Frame, odometry: Odometry, newest: Node | None) -> None:
        """Adds a frame relative to the newest node of its session, None before the first."""
        T_node_base = None
        if odometry.T_odom_base is not None and newest is not None:
            T_node_base = between(newest.T_odom_base, odometry.T_odom_base)
        self.add(frame, odometry, 0 if newest is None else newest.id, T_node_base)

    def add(
        self,
        frame: Frame,
        odometry: Odometry,
        node_id: int,
        T_node_base: Pose | None,
        *,
        lost: str = "",
        covariance: NDArray[np.float64] | None = None,
    ) -> None:
        """Adds a frame where the caller says; ``lost`` is said where odometry has no reason of its own."""
        tracked = TrackedFrame(
            index=frame.index,
            stamp=frame.stamp,
            node_id=node_id,
            T_node_base=T_node_base,
            T_world_base=frame.T_world_base,
            inliers=odometry.inliers,
            odometry_ms=odometry.time_ms,
            lost=lost if odometry.lost is None else odometry.lost.text,
            covariance=covariance,
        )
        self._rows[node_id].append(len(self.frames))
        self.frames.append(tracked)
        self._unwritten.append(tracked)

    def rehang(self, node_id: int, into: int, T_into_node: Pose) -> None:
        """A node became part of another one: its frames hang on that, at the pose that they had.

        Frames that wait to be stored are told to their file with the node that they hang on now.
        """
        first = len(self.frames) - len(self._unwritten)
        for row in self._rows.pop(node_id, []):
            frame = self.frames[row]
            T = None if frame.T_node_base is None else T_into_node @ frame.T_node_base
            self.frames[row] = replace(frame, node_id=into, T_node_base=T)
            self._rows[into].append(row)
            if row >= first:
                self._unwritten[row - first] = self.frames[row]

    def take_unwritten(self) -> tuple[TrackedFrame, ...]:
        """Those that came since this was last asked."""
        unwritten, self._unwritten = self._unwritten, []
        return tuple(unwritten)
