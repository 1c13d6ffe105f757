"""How fast the robot is between two frames: what is seen at speed is blurred."""

from __future__ import annotations

import numpy as np

from slam.geometry import Pose, between, so3_log
from slam.params import Params


class Speed:
    """Remembers the last tracked pose."""

    def __init__(self) -> None:
        self._stamp = 0.0
        self._T_odom_base: Pose | None = None

    def exceeds(self, stamp: float, T_odom_base: Pose | None, params: Params) -> bool:
        """Whether the motion since the last frame was faster than ``RGBD/LinearSpeedUpdate`` or ``AngularSpeedUpdate``.

        As in ``RGBD/LinearUpdate`` each axis counts alone. A frame after a gap in tracking is not too fast.
        """
        last, seconds = self._T_odom_base, stamp - self._stamp
        self._T_odom_base, self._stamp = T_odom_base, stamp
        linear, angular = params.RGBD.LinearSpeedUpdate, params.RGBD.AngularSpeedUpdate
        if last is None or T_odom_base is None or seconds <= 0 or not (linear or angular):
            return False
        T_last_now = between(last, T_odom_base)
        speed, turn = np.abs(T_last_now[:3, 3]).max() / seconds, np.abs(so3_log(T_last_now[:3, :3])).max() / seconds
        return bool((linear and speed > linear) or (angular and turn > angular))
