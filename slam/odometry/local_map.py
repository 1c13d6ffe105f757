"""The points and key frames around the camera that frame-to-map odometry tracks against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Pose, inverse, normalized, transform
from slam.odometry.bundle import adjust
from slam.odometry.shutter import View
from slam.params import Params
from slam.types import Descriptors, Features

_ITERATIONS = 8
#: Of this many times ``OdomF2M/BundleAdjustmentMaxFrames`` key frames, the older ones hold the points that both see.
_KEPT = 3


@dataclass(slots=True)
class _KeyFrame:
    """A key frame's pose and what it saw: point ids (ascending), pixels (M, 2), inverse depths (M,)."""

    T_cam_odom: Pose
    point_ids: NDArray[np.int64]
    pixels: NDArray[np.float64]
    inverse_depths: NDArray[np.float64]


class LocalMap:
    """Points (N, 3) in the odometry frame with descriptors, adjusted together with the last key frames.

    Rows are kept in ascending order of the points' ids.
    """

    def __init__(self, *, last_only: bool = False) -> None:
        """An empty map; with ``last_only`` it never holds more than the points of the newest key frame."""
        self._last_only = last_only
        self._next_id = 1
        self.clear()

    def clear(self) -> None:
        """Let go of all points and key frames."""
        self.points_odom = np.zeros((0, 3))
        self.slopes_odom = np.zeros((0, 3))
        self.descriptors: Descriptors = np.zeros((0, 0), np.uint8)
        self._ids = np.zeros(0, np.int64)
        self._last_seen = np.zeros(0, np.int64)
        self._keyframes: list[_KeyFrame] = []

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
        view: View,
        rows: NDArray[np.int32],
        feature_rows: NDArray[np.int32],
        camera: Camera,
        *,
        frame: int,
        params: Params,
    ) -> Pose:
        """Takes in a frame: new points where it has depth. Returns the pose, adjusted where that is asked for.

        Args:
            T_odom_base: (4, 4) tracked pose.
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
        ids = np.concatenate([self._ids[rows], self._append(T_odom_base, view, new_rows, frame)])
        seen = np.concatenate([feature_rows, new_rows])
        order = np.argsort(ids, kind="stable")
        depths = transform(inverse(camera.T_base_cam), features.points_base[seen])[:, 2]
        T_cam_odom = inverse(T_odom_base @ camera.T_base_cam)
        pixels = features.pixels[seen].astype(np.float64)
        self._keyframes.append(_KeyFrame(T_cam_odom, ids[order], pixels[order], (1.0 / depths)[order]))
        self._keyframes = self._keyframes[-_KEPT * params.OdomF2M.BundleAdjustmentMaxFrames :]
        self._trim(params.OdomF2M.MaxSize)
        if params.OdomF2M.BundleAdjustment and len(self._keyframes) > 1:
            self._adjust(camera, params.OdomF2M.BundleAdjustmentMaxFrames)
        return inverse(self._keyframes[-1].T_cam_odom) @ inverse(camera.T_base_cam)

    def _append(self, T_odom_base: Pose, view: View, rows: NDArray[np.int64], frame: int) -> NDArray[np.int64]:
        ids = np.arange(self._next_id, self._next_id + len(rows), dtype=np.int64)
        self._next_id += len(rows)
        features, R_odom_base = view.features, T_odom_base[:3, :3]
        self.slopes_odom = np.concatenate([self.slopes_odom, view.slopes_base[rows] @ R_odom_base.T])
        self.points_odom = np.concatenate([self.points_odom, transform(T_odom_base, features.points_base[rows])])
        before = self.descriptors if len(self._ids) else features.descriptors[:0]
        self.descriptors = np.concatenate([before, features.descriptors[rows]])
        self._ids = np.concatenate([self._ids, ids])
        self._last_seen = np.concatenate([self._last_seen, np.full(len(rows), frame, np.int64)])
        return ids

    def _trim(self, max_size: int) -> None:
        """Lets go of the points that were not seen for longest."""
        if len(self) <= max_size:
            return
        kept = np.sort(np.argsort(-self._last_seen, kind="stable")[:max_size])
        self.points_odom, self.descriptors = self.points_odom[kept], self.descriptors[kept]
        self.slopes_odom = self.slopes_odom[kept]
        self._ids, self._last_seen = self._ids[kept], self._last_seen[kept]

    def _adjust(self, camera: Camera, free: int) -> None:
        columns = [self._observations(k, keyframe) for k, keyframe in enumerate(self._keyframes)]
        obs_pose, obs_point, pixels, inverse_depths = (np.concatenate(c) for c in zip(*columns, strict=True))
        fixed = max(1, len(self._keyframes) - free)
        moving = np.zeros(len(self), np.bool_)
        moving[obs_point[obs_pose >= fixed]] = True
        order = np.argsort(obs_point, kind="stable")
        order = order[moving[obs_point[order]]]
        poses, points, inliers, _, _ = adjust(
            np.stack([keyframe.T_cam_odom for keyframe in self._keyframes]),
            self.points_odom,
            obs_pose[order],
            obs_point[order],
            pixels[order],
            inverse_depths[order],
            np.array([camera.fx, camera.fy, camera.cx, camera.cy]),
            fixed,
            _ITERATIONS,
        )
        self.points_odom = points
        bad = set(zip(obs_pose[order][~inliers].tolist(), self._ids[obs_point[order][~inliers]].tolist(), strict=True))
        for k, keyframe in enumerate(self._keyframes):
            keyframe.T_cam_odom = normalized(poses[k])
            good = np.array([(k, point_id) not in bad for point_id in keyframe.point_ids.tolist()], np.bool_)
            keyframe.point_ids = keyframe.point_ids[good]
            keyframe.pixels = keyframe.pixels[good]
            keyframe.inverse_depths = keyframe.inverse_depths[good]

    def _observations(
        self, k: int, keyframe: _KeyFrame
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
        """Columns of the observations whose point is still in the map."""
        rows = np.searchsorted(self._ids, keyframe.point_ids)
        rows = np.minimum(rows, len(self._ids) - 1)
        alive = self._ids[rows] == keyframe.point_ids
        count = int(alive.sum())
        return (
            np.full(count, k, np.int32),
            rows[alive].astype(np.int32),
            keyframe.pixels[alive],
            keyframe.inverse_depths[alive],
        )
