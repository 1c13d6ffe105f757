"""The points around the camera that frame-to-map odometry tracks against."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Array, Pose, inverse, transform
from slam.odometry.shutter import View
from slam.odometry.structure import adjust_points
from slam.params import Params
from slam.types import Descriptors, Features


class LocalMap:
    """Points (N, 3) in the odometry frame with descriptors, adjusted to the key frames that see them again.

    Rows are in the order in which the points came.
    """

    def __init__(self, *, last_only: bool = False) -> None:
        """An empty map; with ``last_only`` it never holds more than the points of the newest key frame."""
        self._last_only = last_only
        self.clear()

    def clear(self) -> None:
        """Let go of all points."""
        self.points_odom = np.zeros((0, 3))
        self.slopes_odom = np.zeros((0, 3))
        self.descriptors: Descriptors = np.zeros((0, 0), np.uint8)
        self._last_seen = np.zeros(0, np.int64)
        self._information = np.zeros((0, 3, 3))
        self._looks = np.zeros(0, np.int64)

    def __len__(self) -> int:
        return len(self.points_odom)

    def seen(self, rows: NDArray[np.int32], features: Features, feature_rows: NDArray[np.int32], frame: int) -> None:
        """Points ``rows`` were matched in this frame: they stay longer and take the newest look."""
        self._last_seen[rows] = frame
        self.descriptors[rows] = features.descriptors[feature_rows]

    def shift(self, readout_change_s: float) -> None:
        """The readout time is another than was thought when the points were taken in."""
        self.points_odom = self.points_odom + self.slopes_odom * readout_change_s

    def add_keyframe(
        self,
        T_odom_base: Pose,
        covariance: Array,
        view: View,
        rows: NDArray[np.int32],
        feature_rows: NDArray[np.int32],
        camera: Camera,
        *,
        frame: int,
        params: Params,
    ) -> None:
        """Takes in a frame: new points where it has depth; the others are adjusted where that is asked for.

        Args:
            T_odom_base: (4, 4) tracked pose, which is held ...
            covariance: (6, 6) ... and how uncertain it is; 0 where the map begins.
            view: what the frame saw.
            rows: (M,) points of the map that the frame saw ...
            feature_rows: (M,) ... and the features that showed them.
            camera: of the frame.
            frame: its number.
            params: the OdomF2M group is read.
        """
        features = view.features
        if self._last_only:
            self.clear()
            rows = feature_rows = np.zeros(0, np.int32)
        new = np.isfinite(features.points_base[:, 0])
        new[feature_rows] = False
        new_rows = np.flatnonzero(new)
        all_rows = np.concatenate([rows, np.arange(len(self), len(self) + len(new_rows))])
        self._append(T_odom_base, view, new_rows, frame)
        if params.OdomF2M.BundleAdjustment:
            variances = covariance.diagonal()
            uncertain = float(variances[:3].mean()), float(variances[3:].mean())
            self._adjust(
                T_odom_base, uncertain, features, all_rows, np.concatenate([feature_rows, new_rows]), camera, params
            )
        self._trim(params.OdomF2M.MaxSize)

    def _adjust(
        self,
        T_odom_base: Pose,
        pose_variances: tuple[float, float],
        features: Features,
        rows: NDArray[np.int64],
        feature_rows: NDArray[np.int64],
        camera: Camera,
        params: Params,
    ) -> None:
        """The points move to where this key frame and those before it saw them."""
        depths = transform(inverse(camera.T_base_cam), features.points_base[feature_rows])[:, 2]
        adjust_points(
            self.points_odom,
            self._information,
            self._looks,
            rows,
            inverse(T_odom_base @ camera.T_base_cam),
            pose_variances,
            features.pixels[feature_rows].astype(np.float64),
            1.0 / depths,
            np.array([camera.fx, camera.fy, camera.cx, camera.cy]),
            params.OdomF2M.BundleAdjustmentMaxFrames,
        )

    def _append(self, T_odom_base: Pose, view: View, rows: NDArray[np.int64], frame: int) -> None:
        features, R_odom_base = view.features, T_odom_base[:3, :3]
        before = self.descriptors if len(self) else features.descriptors[:0]
        self.slopes_odom = np.concatenate([self.slopes_odom, view.slopes_base[rows] @ R_odom_base.T])
        self.points_odom = np.concatenate([self.points_odom, transform(T_odom_base, features.points_base[rows])])
        self.descriptors = np.concatenate([before, features.descriptors[rows]])
        self._last_seen = np.concatenate([self._last_seen, np.full(len(rows), frame, np.int64)])
        self._information = np.concatenate([self._information, np.zeros((len(rows), 3, 3))])
        self._looks = np.concatenate([self._looks, np.zeros(len(rows), np.int64)])

    def _trim(self, max_size: int) -> None:
        """Lets go of the points that were not seen for longest."""
        if len(self) <= max_size:
            return
        kept = np.sort(np.argsort(-self._last_seen, kind="stable")[:max_size])
        self.points_odom, self.descriptors = self.points_odom[kept], self.descriptors[kept]
        self.slopes_odom = self.slopes_odom[kept]
        self._information, self._looks = self._information[kept], self._looks[kept]
        self._last_seen = self._last_seen[kept]
