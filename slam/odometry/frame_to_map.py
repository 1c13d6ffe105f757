"""Frame-to-map visual odometry."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.extract import Extractor
from slam.features.match import match_all, match_near
from slam.geometry import Pose, between, inverse, transform
from slam.odometry.local_map import LocalMap
from slam.params import Params
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.types import UNKNOWN_VARIANCE, Features, Frame, Odometry, Refusal

#: After a first pose is known, projected points are searched again this near.
_NARROW_PX = 8.0
#: With fewer inliers than this share of the matches, the guess itself is in doubt.
_DOUBTFUL = 0.5


class FrameToMap:
    """Tracks each frame against a local map of 3D points (``Odom/Strategy`` 0 of RTAB-Map)."""

    def __init__(self) -> None:
        self._extractor = Extractor()
        self._map = LocalMap()
        self._T_odom_base: Pose = np.eye(4)
        self._motion: Pose = np.eye(4)
        self._frame = 0
        self._begun = False
        self._lost_frames = 0

    def track(self, frame: Frame, params: Params) -> Odometry:
        """Pose of a frame in the odometry frame, or why there is none."""
        start = time.perf_counter()
        features = self._extractor.extract(frame, params)
        self._frame += 1
        if len(self._map) == 0:
            return self._begin(frame, features, params, start)
        guess = self._T_odom_base @ self._motion if params.Odom.GuessMotion else self._T_odom_base
        T_odom_base, matches, inliers = self._register(features, frame.camera, guess, params)
        if inliers.sum() < max(params.Vis.MinInliers, _DOUBTFUL * len(matches)):
            without_guess = self._relocate(features, frame.camera, params)
            if without_guess[2].sum() > inliers.sum():
                T_odom_base, matches, inliers = without_guess
        agreed = int(inliers.sum())
        if agreed < params.Vis.MinInliers:
            return self._lose(features, matches, agreed, params, start)
        return self._advance(frame, features, T_odom_base, matches, inliers, params, start)

    def _begin(self, frame: Frame, features: Features, params: Params, start: float) -> Odometry:
        """First key frame of a local map; its covariance says that the chain starts here."""
        with_depth = int(np.isfinite(features.points_base[:, 0]).sum())
        if with_depth < params.Vis.MinInliers:
            return self._refused("features with depth", with_depth, 0, 0, features, params, start)
        if not self._begun and frame.T_gravity_base is not None:
            # Level from the start: the map's z points up, as grids and views expect.
            self._T_odom_base = frame.T_gravity_base
        self._begun = True
        rows = np.zeros(0, np.int32)
        self._map.add_keyframe(self._T_odom_base, features, rows, rows, frame.camera, frame=self._frame, params=params)
        covariance = np.eye(6) * UNKNOWN_VARIANCE
        return Odometry(self._T_odom_base, covariance, features, 0, with_depth, True, None, _ms(start))

    def _register(
        self, features: Features, camera: Camera, guess: Pose, params: Params
    ) -> tuple[Pose, NDArray[np.int32], NDArray[np.bool_]]:
        """Guided matching around the guess, then once more, nearer, around the pose found."""
        matches = self._match_projected(features, camera, guess, float(params.Vis.CorGuessWinSize), params)
        T_odom_base, inliers = self._solve(features, matches, camera, guess, params)
        if inliers.sum() >= params.Vis.MinInliers:
            matches = self._match_projected(features, camera, T_odom_base, _NARROW_PX, params)
            T_odom_base, inliers = self._solve(features, matches, camera, T_odom_base, params)
        return T_odom_base, matches, inliers

    def _relocate(
        self, features: Features, camera: Camera, params: Params
    ) -> tuple[Pose, NDArray[np.int32], NDArray[np.bool_]]:
        """Matching without a guess: the camera moved too fast, or comes back from being lost."""
        matches = match_all(self._map.descriptors, features.descriptors, ratio=params.Vis.CorNNDR)
        T_odom_base, inliers = self._solve(features, matches, camera, None, params)
        if inliers.sum() >= params.Vis.MinInliers:
            matches = self._match_projected(features, camera, T_odom_base, _NARROW_PX, params)
            T_odom_base, inliers = self._solve(features, matches, camera, T_odom_base, params)
        return T_odom_base, matches, inliers

    def _match_projected(
        self, features: Features, camera: Camera, T_odom_base: Pose, radius: float, params: Params
    ) -> NDArray[np.int32]:
        points_cam = transform(inverse(T_odom_base @ camera.T_base_cam), self._map.points_odom)
        predicted = camera.project(points_cam)
        outside = ~((predicted >= 0) & (predicted < (camera.width, camera.height))).all(axis=1)
        predicted[outside] = np.nan
        return match_near(
            predicted.astype(np.float32),
            self._map.descriptors,
            features.pixels,
            features.descriptors,
            radius=radius,
            ratio=params.Vis.CorNNDR,
        )

    def _solve(
        self, features: Features, matches: NDArray[np.int32], camera: Camera, guess: Pose | None, params: Params
    ) -> tuple[Pose, NDArray[np.bool_]]:
        if len(matches) < params.Vis.MinInliers:
            return self._T_odom_base, np.zeros(len(matches), np.bool_)
        return solve_pnp(
            self._map.points_odom[matches[:, 0]],
            features.pixels[matches[:, 1]],
            features.points_base[matches[:, 1]],
            camera,
            params,
            T_ref_base=guess,
        )

    def _advance(
        self,
        frame: Frame,
        features: Features,
        T_odom_base: Pose,
        matches: NDArray[np.int32],
        inliers: NDArray[np.bool_],
        params: Params,
        start: float,
    ) -> Odometry:
        rows, feature_rows = matches[inliers].T
        covariance = spread_covariance(
            self._map.points_odom[rows], features.points_base[feature_rows], T_odom_base, frame.camera, params
        )
        self._map.seen(rows, features, feature_rows, self._frame)
        agreed = int(inliers.sum())
        keyframe = agreed <= params.Odom.VisKeyFrameThr or agreed <= params.Odom.KeyFrameThr * len(features)
        if keyframe:
            T_odom_base = self._map.add_keyframe(
                T_odom_base,
                features,
                rows,
                feature_rows,
                frame.camera,
                frame=self._frame,
                params=params,
            )
        # After a gap the motion covers several frames and predicts nothing.
        self._motion = between(self._T_odom_base, T_odom_base) if self._lost_frames == 0 else np.eye(4)
        self._T_odom_base = T_odom_base
        self._lost_frames = 0
        return Odometry(T_odom_base, covariance, features, len(matches), agreed, keyframe, None, _ms(start))

    def _lose(
        self, features: Features, matches: NDArray[np.int32], agreed: int, params: Params, start: float
    ) -> Odometry:
        self._lost_frames += 1
        self._motion = np.eye(4)
        lost = self._refused("Vis/MinInliers", agreed, len(matches), agreed, features, params, start)
        if 0 < params.Odom.ResetCountdown <= self._lost_frames:
            self._map = LocalMap()
            self._lost_frames = 0
        return lost

    def _refused(
        self, test: str, value: int, matches: int, inliers: int, features: Features, params: Params, start: float
    ) -> Odometry:
        threshold = params.Vis.MinInliers
        text = f"{value} {'inliers' if test.startswith('Vis') else test}, fewer than Vis/MinInliers {threshold}"
        refusal = Refusal(test, float(value), float(threshold), text)
        covariance = np.eye(6) * UNKNOWN_VARIANCE
        return Odometry(None, covariance, features, matches, inliers, False, refusal, _ms(start))


def _ms(start: float) -> float:
    return (time.perf_counter() - start) * 1e3
