"""Frame-to-map visual odometry."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.match import match_all, match_near
from slam.features.prepared import PreparedExtractor
from slam.geometry import Array, Pose, between, flattened, inverse, se3_log, transform
from slam.odometry.kalman import VelocityFilter
from slam.odometry.local_map import LocalMap
from slam.odometry.shutter import MAX_INTERVAL_S, Readout, View, pixel_jacobian, straighten
from slam.params import Params
from slam.registration.pnp import solve_pnp, spread_covariance
from slam.types import UNKNOWN_VARIANCE, ExternalOdometry, Features, Frame, Odometry, Refusal

#: After a first pose is known, projected points are searched again this near.
_NARROW_PX = 8.0
#: Where the camera turned faster than guessed, points are looked for in windows this many times as wide.
_WIDER = (2.0, 4.0)
#: With fewer inliers than this share of the matches, the guess itself is in doubt.
_DOUBTFUL = 0.5


@dataclass(frozen=True, slots=True)
class _Track:
    """A pose, what was seen from it, rows (map, view) that were matched (M, 2), and which agree with the pose (M,)."""

    T_odom_base: Pose
    view: View
    matches: NDArray[np.int32]
    inliers: NDArray[np.bool_]

    @property
    def agreed(self) -> int:
        return int(self.inliers.sum())


class FrameToMap:
    """Tracks each frame against a local map of 3D points (``Odom/Strategy`` 0 of RTAB-Map)."""

    def __init__(self, local_map: LocalMap) -> None:
        """Tracks against an empty map, which decides what of a key frame it keeps."""
        self._extractor = PreparedExtractor()
        self._map = local_map
        self._filter = VelocityFilter()
        self._external: ExternalOdometry | None = None
        self._readout = Readout()
        self._T_odom_base: Pose = np.eye(4)
        self._motion: Pose = np.eye(4)
        self._twist_cam = np.zeros(6)
        self._stamp = -np.inf
        self._frame = 0
        self._begun = False
        self._lost_frames = 0

    def prepare(self, frame: Frame, params: Params) -> None:
        """Extracts the features of a frame that is tracked soon; from another thread."""
        self._extractor.prepare(frame, params)

    def track(self, frame: Frame, params: Params) -> Odometry:
        """Pose of a frame in the odometry frame, or why there is none."""
        found = self._extractor.extract(frame, params)
        # Wherever the features were extracted, they are part of what odometry takes.
        start = time.perf_counter() - found.time_ms * 1e-3
        features = found.features
        self._frame += 1
        if len(self._map) == 0:
            return self._begin(frame, features, params, start)
        guess = self._T_odom_base @ self._guessed_motion(frame, params)
        track = self._register(frame, features, guess, params)
        if track.agreed < max(params.Vis.MinInliers, _DOUBTFUL * len(track.matches)):
            without_guess = self._relocate(track.view, frame.camera, params)
            if without_guess.agreed > track.agreed:
                track = without_guess
        if track.agreed < params.Vis.MinInliers:
            track = self._look_wider(track, frame.camera, guess, params)
        if track.agreed < params.Vis.MinInliers:
            return self._lose(track, params, start)
        return self._advance(frame, track, params, start)

    def _guessed_motion(self, frame: Frame, params: Params) -> Pose:
        """Motion since the last tracked frame: as odometry from outside has it, or like the motion before."""
        given, last = frame.external, self._external
        if params.Odom.External and given is not None and last is not None:
            return between(last.T_odom_base, given.T_odom_base)
        return self._motion if params.Odom.GuessMotion else np.eye(4)

    def _begin(self, frame: Frame, features: Features, params: Params, start: float) -> Odometry:
        """First key frame of a local map; its covariance says that the chain starts here."""
        with_depth = int(np.isfinite(features.points_base[:, 0]).sum())
        if with_depth < params.Vis.MinInliers:
            return self._refused("features with depth", with_depth, 0, 0, features, params, start)
        if not self._begun and frame.T_gravity_base is not None and not params.Reg.Force3DoF:
            # Level from the start: the map's z points up, as grids and views expect.
            self._T_odom_base = frame.T_gravity_base
        self._begun = True
        self._stamp, self._external = frame.stamp, frame.external
        rows = np.zeros(0, np.int32)
        view = View.still(features)
        exact = np.zeros((6, 6))
        self._map.add_keyframe(
            self._T_odom_base, exact, view, rows, rows, frame.camera, frame=self._frame, params=params
        )
        covariance = np.eye(6) * UNKNOWN_VARIANCE
        return Odometry(self._T_odom_base, covariance, features, 0, with_depth, True, None, _ms(start))

    def _register(self, frame: Frame, features: Features, guess: Pose, params: Params) -> _Track:
        """Guided matching around the guess, then once more, nearer, around the pose found."""
        view = self._straighten(frame, features, self._twist_cam, params)
        track = self._near(view, frame.camera, guess, float(params.Vis.CorGuessWinSize), params, rounds=1)
        if track.agreed < params.Vis.MinInliers:
            return track
        twist_cam = self._twist(frame, track.T_odom_base)
        view = self._straighten(frame, features, twist_cam, params)
        return self._near(view, frame.camera, track.T_odom_base, _NARROW_PX, params)

    def _relocate(self, view: View, camera: Camera, params: Params) -> _Track:
        """Matching without a guess: the camera moved too fast, or comes back from being lost."""
        features = view.features
        matches = match_all(self._map.descriptors, features.descriptors, ratio=params.Vis.CorNNDR)
        track = self._solve(view, matches, camera, None, params)
        if track.agreed < params.Vis.MinInliers:
            return track
        return self._near(view, camera, track.T_odom_base, _NARROW_PX, params)

    def _look_wider(self, lost: _Track, camera: Camera, guess: Pose, params: Params) -> _Track:
        """The first of ever wider windows around the guess, and around the last pose, in which enough points agree."""
        guesses = [guess] if np.array_equal(guess, self._T_odom_base) else [guess, self._T_odom_base]
        for T_odom_base, wider in product(guesses, _WIDER):
            radius = wider * params.Vis.CorGuessWinSize
            track = self._near(lost.view, camera, T_odom_base, radius, params)
            if track.agreed >= params.Vis.MinInliers:
                return self._near(lost.view, camera, track.T_odom_base, _NARROW_PX, params)
        return lost

    def _near(
        self, view: View, camera: Camera, T_odom_base: Pose, radius: float, params: Params, *, rounds: int = 3
    ) -> _Track:
        """Matches within ``radius`` pixels of where the points should be, and the pose they give."""
        points_cam = transform(inverse(T_odom_base @ camera.T_base_cam), self._map.points_odom)
        predicted = camera.project(points_cam)
        outside = ~((predicted >= 0) & (predicted < (camera.width, camera.height))).all(axis=1)
        predicted[outside] = np.nan
        matches = match_near(
            predicted.astype(np.float32),
            self._map.descriptors,
            view.features.pixels,
            view.features.descriptors,
            radius=radius,
            ratio=params.Vis.CorNNDR,
        )
        return self._solve(view, matches, camera, T_odom_base, params, rounds)

    def _solve(
        self,
        view: View,
        matches: NDArray[np.int32],
        camera: Camera,
        guess: Pose | None,
        params: Params,
        rounds: int = 3,
    ) -> _Track:
        if len(matches) < params.Vis.MinInliers:
            return _Track(self._T_odom_base, view, matches, np.zeros(len(matches), np.bool_))
        T_odom_base, inliers = solve_pnp(
            self._map.points_odom[matches[:, 0]],
            view.features.pixels[matches[:, 1]],
            view.features.points_base[matches[:, 1]],
            camera,
            params,
            T_ref_base=guess,
            rounds=rounds,
        )
        return _Track(T_odom_base, view, matches, inliers)

    def _straighten(self, frame: Frame, features: Features, twist_cam: Array, params: Params) -> View:
        return straighten(features, frame, twist_cam, self._readout.seconds(params), params)

    def _twist(self, frame: Frame, T_odom_base: Pose) -> Array:
        """Velocity (6,) of the camera since the last frame, per second, in its own frame; 0 where nobody knows."""
        interval_s = frame.stamp - self._stamp
        if self._lost_frames or not 0.0 < interval_s <= MAX_INTERVAL_S:
            return np.zeros(6)
        T_base_cam = frame.camera.T_base_cam
        return se3_log(between(self._T_odom_base @ T_base_cam, T_odom_base @ T_base_cam)) / interval_s

    def _advance(self, frame: Frame, track: _Track, params: Params, start: float) -> Odometry:
        T_odom_base, features = track.T_odom_base, track.view.features
        if params.Reg.Force3DoF:
            T_odom_base = flattened(T_odom_base)
        rows, feature_rows = track.matches[track.inliers].T
        covariance = spread_covariance(
            self._map.points_odom[rows], features.points_base[feature_rows], T_odom_base, frame.camera, params
        )
        self._twist_cam = self._twist(frame, T_odom_base)
        view = track.view
        if params.Odom.ReadoutTime < 0:
            view = self._learn_readout(track, rows, feature_rows, frame.camera)
        self._map.seen(rows, features, feature_rows, self._frame)
        keyframe = track.agreed <= params.Odom.VisKeyFrameThr or track.agreed <= params.Odom.KeyFrameThr * len(features)
        if keyframe:
            self._map.add_keyframe(
                T_odom_base, covariance, view, rows, feature_rows, frame.camera, frame=self._frame, params=params
            )
        # After a gap the motion covers several frames and predicts nothing.
        self._motion = between(self._T_odom_base, T_odom_base) if self._lost_frames == 0 else np.eye(4)
        self._T_odom_base, self._stamp, self._external = T_odom_base, frame.stamp, frame.external
        self._lost_frames = 0
        smooth = self._filter.smooth(T_odom_base, frame.stamp, params)
        return Odometry(smooth, covariance, features, len(track.matches), track.agreed, keyframe, None, _ms(start))

    def _learn_readout(
        self, track: _Track, rows: NDArray[np.int32], feature_rows: NDArray[np.int32], camera: Camera
    ) -> View:
        """Learns from what was missed; the view, with the pose's own dependence on the readout in its slopes."""
        if not (track.view.rates.any() or self._map.slopes_odom[rows].any()):
            # Nothing here depends on the readout: the camera stands, or nobody knows how it moves.
            return track.view
        T_cam_odom = inverse(track.T_odom_base @ camera.T_base_cam)
        points_cam = transform(T_cam_odom, self._map.points_odom[rows])
        jacobian = pixel_jacobian(points_cam, camera)
        slopes_cam = self._map.slopes_odom[rows] @ T_cam_odom[:3, :3].T
        slopes = track.view.rates[feature_rows] - np.einsum("nij,nj->ni", jacobian[:, :, :3], slopes_cam)
        missed = track.view.features.pixels[feature_rows] - camera.project(points_cam)
        change_s, follows = self._readout.learn(missed, slopes, jacobian)
        self._map.shift(change_s)
        return track.view.following(follows, camera)

    def _lose(self, track: _Track, params: Params, start: float) -> Odometry:
        self._lost_frames += 1
        self._motion, self._twist_cam = np.eye(4), np.zeros(6)
        self._filter.restart()
        features, agreed = track.view.features, track.agreed
        lost = self._refused("Vis/MinInliers", agreed, len(track.matches), agreed, features, params, start)
        if 0 < params.Odom.ResetCountdown <= self._lost_frames:
            self._map.clear()
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
