"""What a moving camera does to its pictures, taken back: rows exposed one after another, and depth of another moment.

The rows of a rolling shutter are exposed over the readout time. A picture is straightened by moving each key point to
where it would be seen in the middle of the readout (to first order; Forssen and Ringaby 2010 do so for a turning
camera). How long the readout is tells the error that is left when it is ignored: the readout is one more unknown
beside the pose, and the same one for all frames.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.depth import depth_at
from slam.geometry import Array, inverse, transform
from slam.params import Params
from slam.types import Features, Frame

#: Over a longer gap between frames, the mean motion does not tell how the camera moved while it exposed.
MAX_INTERVAL_S = 0.1
#: Readouts are shorter than the time between two frames of a 20 Hz camera.
_MAX_READOUT_S = 0.05
#: What is not much longer is as good as a global shutter.
_LEAST_READOUT_S = 0.004
#: The estimate in use follows the newest one in steps of this size, so that the map is not moved at every frame.
_STEP_S = 0.001
#: Errors of neighbouring key points and frames are alike, so that each counts for less than one.
_CORRELATED = 25.0
_SIGMAS = 3.0
_PRIOR_S = 0.05
_TWO_PIXELS_2 = 4.0


@dataclass(frozen=True, slots=True)
class View:
    """Straightened features.

    Attributes:
        features: as a camera sees them that takes the whole picture, and depth, at one moment.
        slopes_base: (N, 3) change of ``features.points_base`` with the readout, metres per second; 0 without depth.
        rates: (N, 2) change of ``features.pixels`` with the readout, pixels per second.
    """

    features: Features
    slopes_base: Array
    rates: Array

    @classmethod
    def still(cls, features: Features) -> View:
        """Features of a camera that stands."""
        count = len(features)
        return cls(features, np.zeros((count, 3)), np.zeros((count, 2)))

    def following(self, tangent_cam: Array, camera: Camera) -> View:
        """The same with slopes of a pose that moves by ``tangent_cam`` (6,) for each second of readout."""
        points_cam = transform(inverse(camera.T_base_cam), self.features.points_base)
        moved = tangent_cam[:3] + np.cross(tangent_cam[3:], points_cam)
        return replace(self, slopes_base=self.slopes_base - np.nan_to_num(moved) @ camera.T_base_cam[:3, :3].T)


def straighten(features: Features, frame: Frame, twist_cam: Array, readout_s: float, params: Params) -> View:
    """Features of a frame whose camera moves with ``twist_cam`` (6,), metres and radians per second, own frame."""
    camera = frame.camera
    points_cam = transform(inverse(camera.T_base_cam), features.points_base)
    known = np.isfinite(points_cam[:, 2])
    if not known.any() or not twist_cam.any():
        return View.still(features)
    depth = points_cam[:, 2]
    points_cam = camera.unproject(features.pixels, np.where(known, depth, np.median(depth[known])))
    velocity = -(twist_cam[:3] + np.cross(twist_cam[3:], points_cam))
    flow = _flow(points_cam, velocity, camera)
    if frame.depth_delay_s:
        # The depth camera saw the point where it was then, and as far away as it was then.
        depth = depth_at(frame.depth_m, features.pixels + flow * frame.depth_delay_s, params.Vis)
        depth = depth - velocity[:, 2] * frame.depth_delay_s
    rates = -flow * (features.pixels[:, 1:] / camera.height - 0.5)
    pixels = (features.pixels + rates * readout_s).astype(np.float32)
    points_base = transform(camera.T_base_cam, camera.unproject(pixels, depth)).astype(np.float32)
    slopes_cam = np.column_stack([rates * depth[:, None] / (camera.fx, camera.fy), np.zeros(len(depth))])
    slopes_base = np.nan_to_num(slopes_cam) @ camera.T_base_cam[:3, :3].T
    return View(replace(features, pixels=pixels, points_base=points_base), slopes_base, rates)


class Readout:
    """The readout time of the camera: given, or learned from how pixels miss the map while the camera moves."""

    def __init__(self) -> None:
        self._information = 1.0 / _PRIOR_S**2
        self._weighted = 0.0
        self._in_use = 0.0

    def seconds(self, params: Params) -> float:
        """What ``Odom/ReadoutTime`` says, or the estimate where it is left to us."""
        if params.Odom.ReadoutTime >= 0:
            return float(params.Odom.ReadoutTime) * 1e-3
        return self._in_use

    def learn(self, missed: Array, slopes: Array, jacobian: Array) -> tuple[float, Array]:
        """Takes in one frame; returns by how much the readout in use changes, seconds, and how the pose would follow.

        The latter (6,) is the tangent per second of readout that keeps the predicted pixels at the seen ones.

        Args:
            missed: (N, 2) seen minus predicted pixels.
            slopes: (N, 2) change of ``missed`` with the readout, pixels per second.
            jacobian: (N, 2, 6) change of the predicted pixels with the pose's tangent.
        """
        weights = np.repeat(1.0 / (1.0 + (missed**2).sum(axis=1) / _TWO_PIXELS_2), 2)
        a, r, G = slopes.reshape(-1), missed.reshape(-1), jacobian.reshape(-1, 6)
        weighted = G * weights[:, None]
        # What a change of the pose could explain as well says nothing about the readout.
        follows = np.linalg.lstsq(weighted.T @ G, weighted.T @ a, rcond=None)[0]
        own = a - G @ follows
        information = float((weights * own) @ a) / _CORRELATED
        self._information += information
        self._weighted += information * self._in_use - float((weights * own) @ r) / _CORRELATED
        return self._follow(), follows

    def _follow(self) -> float:
        estimate = float(np.clip(self._weighted / self._information, -_MAX_READOUT_S, _MAX_READOUT_S))
        certain = abs(estimate) > max(_LEAST_READOUT_S, _SIGMAS / np.sqrt(self._information))
        wanted = estimate if certain else 0.0
        if abs(wanted - self._in_use) < _STEP_S:
            return 0.0
        change, self._in_use = wanted - self._in_use, wanted
        return change


def pixel_jacobian(points_cam: Array, camera: Camera) -> Array:
    """(N, 2, 6): change of a point's pixel with a tangent (translation first) that acts on the points from the left."""
    flows = [_flow(points_cam, np.broadcast_to(axis, points_cam.shape), camera) for axis in np.eye(3)]
    flows += [_flow(points_cam, np.cross(axis, points_cam), camera) for axis in np.eye(3)]
    return np.stack(flows, axis=2)


def _flow(points_cam: Array, velocity: Array, camera: Camera) -> NDArray[np.float64]:
    """Pixels per second (N, 2) of points (N, 3) that move with ``velocity`` (N, 3) in the camera frame."""
    z = points_cam[:, 2:]
    across = velocity[:, :2] - points_cam[:, :2] * velocity[:, 2:] / z
    return across / z * (camera.fx, camera.fy)
