"""Random points that a camera with a known pose sees, with noise and outliers where wanted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.geometry import Array, Pose, inverse, make, se3_exp, so3_exp, transform
from slam.registration.pose import SIGMA_INVERSE_DEPTH

CAMERA = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
INTRINSICS = np.array([525.0, 525.0, 319.5, 239.5])


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """What one view sees of a scene.

    Attributes:
        T_ref_base: (4, 4) true pose of the view.
        points_ref: (N, 3) metres.
        pixels: (N, 2) float32.
        inverse_depth: (N,) 1 / metres along the optical axis, NaN where it is silent.
        points_base: (N, 3) float32, what its own depth says, NaN where it is silent.
        outlier: (N,) whether the pixel is wrong.
    """

    T_ref_base: Pose
    points_ref: Array
    pixels: NDArray[np.float32]
    inverse_depth: Array
    points_base: NDArray[np.float32]
    outlier: NDArray[np.bool_]

    @property
    def T_cam_ref(self) -> Pose:
        """(4, 4) true pose as the optimiser has it."""
        return inverse(self.T_ref_base @ CAMERA.T_base_cam)


def random_pose(rng: np.random.Generator, metres: float = 1.0, radians: float = 0.5) -> Pose:
    """A pose this near to identity on every axis."""
    return make(so3_exp(rng.uniform(-radians, radians, 3)), rng.uniform(-metres, metres, 3))


def nudged(T: Pose, rng: np.random.Generator, metres: float, radians: float) -> Pose:
    """A pose near another."""
    return np.asarray(se3_exp(np.concatenate([rng.normal(size=3) * metres, rng.normal(size=3) * radians])) @ T)


def view(
    seed: int,
    count: int = 120,
    *,
    pixel_noise: float = 0.0,
    depth_noise: float = 0.0,
    outliers: float = 0.0,
    with_depth: float = 0.7,
) -> View:
    """A view from a random pose.

    Args:
        seed: of everything.
        count: points.
        pixel_noise: standard deviation in pixels.
        depth_noise: standard deviation of the inverse depth, in units of ``SIGMA_INVERSE_DEPTH``.
        outliers: share of points that are seen anywhere but where they are.
        with_depth: share of points of which the view knows the depth.
    """
    rng = np.random.default_rng(seed)
    T_ref_base = random_pose(rng)
    z = rng.uniform(0.8, 6.0, count)
    true = rng.uniform((10, 10), (630, 470), (count, 2))
    points_ref = transform(T_ref_base @ CAMERA.T_base_cam, CAMERA.unproject(true, z))
    pixels = true + rng.normal(size=(count, 2)) * pixel_noise
    outlier = np.arange(count) < round(outliers * count)
    pixels[outlier] = rng.uniform((10, 10), (630, 470), (int(outlier.sum()), 2))
    inverse_depth = 1 / z + rng.normal(size=count) * depth_noise * SIGMA_INVERSE_DEPTH
    inverse_depth[rng.random(count) >= with_depth] = np.nan
    points_base = transform(CAMERA.T_base_cam, CAMERA.unproject(pixels, 1 / inverse_depth))
    return View(
        T_ref_base, points_ref, pixels.astype(np.float32), inverse_depth, points_base.astype(np.float32), outlier
    )
