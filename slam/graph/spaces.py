"""Poses and factors in three dimensions, and in the plane (``Reg/Force3DoF``), as GTSAM has them.

GTSAM orders the tangent of a Pose3 rotation first; links have their information translation first, as everywhere in
slamdeck. The rows and columns are exchanged here and nowhere else.
"""

from __future__ import annotations

from typing import Protocol

import gtsam
import numpy as np
from numpy.typing import NDArray

from slam.geometry import Array, Pose, flat, planar
from slam.params import Params


class Space(Protocol):
    """What differs between both.

    Attributes:
        axes: rows of a link's information in the order of GTSAM's tangent.
        linear: those of them that are translation, x first.
    """

    axes: NDArray[np.intp]
    linear: NDArray[np.intp]

    def flat(self, T: Array) -> Array:
        """Poses (N, 4, 4) as this space has them."""
        ...

    def value(self, T: Pose) -> gtsam.Pose3 | gtsam.Pose2:
        """One pose."""
        ...

    def between(self, a: int, b: int, T_a_b: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """Pose b is T_a_b away from pose a."""
        ...

    def prior(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """A pose is known."""
        ...

    def position(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """The position of a pose is known."""
        ...

    def sighting(self, key: int, point: int, point_base: Array, information: Array) -> gtsam.NoiseModelFactor:
        """A point was seen from a pose: information (k, k) of its position there."""
        ...

    def poses(self, values: gtsam.Values) -> Array:
        """All poses (N, 4, 4) by ascending key."""
        ...

    def point(self, values: gtsam.Values, key: int) -> Array:
        """A point (3,)."""
        ...


class Spatial:
    """Three dimensions."""

    axes = np.array([3, 4, 5, 0, 1, 2])
    linear = np.array([0, 1, 2])

    def flat(self, T: Array) -> Array:
        """As they are."""
        return T

    def value(self, T: Pose) -> gtsam.Pose3:
        """One pose."""
        return gtsam.Pose3(T)

    def between(self, a: int, b: int, T_a_b: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """Pose b is T_a_b away from pose a."""
        return gtsam.BetweenFactorPose3(a, b, gtsam.Pose3(T_a_b), noise)

    def prior(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """A pose is known."""
        return gtsam.PriorFactorPose3(key, gtsam.Pose3(T), noise)

    def position(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """The position of a pose is known."""
        return gtsam.PoseTranslationPrior3D(key, T[:3, 3], noise)

    def sighting(self, key: int, point: int, point_base: Array, information: Array) -> gtsam.NoiseModelFactor:
        """A point was seen from a pose; to first order its position is its direction's two axes and its distance."""
        metres, direction = float(np.linalg.norm(point_base)), gtsam.Unit3(point_base)
        J = np.column_stack([metres * direction.basis(), point_base / metres])
        noise = gtsam.noiseModel.Gaussian.Information(J.T @ information @ J)
        return gtsam.BearingRangeFactor3D(key, point, direction, metres, noise)

    def poses(self, values: gtsam.Values) -> Array:
        """All poses (N, 4, 4) by ascending key."""
        rows = gtsam.utilities.extractPose3(values)
        T = np.zeros((len(rows), 4, 4))
        T[:, :3, :3] = rows[:, :9].reshape(-1, 3, 3)
        T[:, :3, 3] = rows[:, 9:]
        T[:, 3, 3] = 1.0
        return T

    def point(self, values: gtsam.Values, key: int) -> Array:
        """A point (3,)."""
        return np.asarray(values.atPoint3(key))


class Planar:
    """The plane z = 0: x, y and yaw."""

    axes = np.array([0, 1, 5])
    linear = np.array([0, 1])

    def flat(self, T: Array) -> Array:
        """Height, roll and pitch taken out."""
        return flat(T)

    def value(self, T: Pose) -> gtsam.Pose2:
        """One pose."""
        return gtsam.Pose2(T[0, 3], T[1, 3], np.arctan2(T[1, 0], T[0, 0]))

    def between(self, a: int, b: int, T_a_b: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """Pose b is T_a_b away from pose a."""
        return gtsam.BetweenFactorPose2(a, b, self.value(T_a_b), noise)

    def prior(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """A pose is known."""
        return gtsam.PriorFactorPose2(key, self.value(T), noise)

    def position(self, key: int, T: Pose, noise: gtsam.noiseModel.Base) -> gtsam.NoiseModelFactor:
        """The position of a pose is known."""
        return gtsam.PoseTranslationPrior2D(key, T[:2, 3], noise)

    def sighting(self, key: int, point: int, point_base: Array, information: Array) -> gtsam.NoiseModelFactor:
        """A point was seen from a pose; to first order its position is its bearing and its distance."""
        x, y = point_base[:2]
        metres = float(np.hypot(x, y))
        J = np.array([[-y, x / metres], [x, y / metres]])
        noise = gtsam.noiseModel.Gaussian.Information(J.T @ information @ J)
        return gtsam.BearingRangeFactor2D(key, point, gtsam.Rot2(float(np.arctan2(y, x))), metres, noise)

    def poses(self, values: gtsam.Values) -> Array:
        """All poses (N, 4, 4) by ascending key."""
        x, y, yaw = gtsam.utilities.extractPose2(values).T
        return planar(x, y, np.cos(yaw), np.sin(yaw))

    def point(self, values: gtsam.Values, key: int) -> Array:
        """A point (3,), on the floor."""
        return np.append(values.atPoint2(key), 0.0)


SPATIAL, PLANAR = Spatial(), Planar()


def choose_space(params: Params) -> Space:
    """The space that ``Reg/Force3DoF`` asks for."""
    return PLANAR if params.Reg.Force3DoF else SPATIAL
