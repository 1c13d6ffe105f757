"""The pinhole camera of a rectified image and the frames it connects."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

#: Optical frame (x right, y down, z forward) to base frame (x forward, y left, z up).
T_BASE_OPTICAL: NDArray[np.float64] = np.array(
    [[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A rectified pinhole camera.

    Attributes:
        width: image width in pixels.
        height: image height in pixels.
        fx: focal length along x in pixels.
        fy: focal length along y in pixels.
        cx: principal point x in pixels (pixel centres at integer coordinates).
        cy: principal point y in pixels.
        T_base_cam: (4, 4) pose of the optical frame in the base frame, metres.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    T_base_cam: NDArray[np.float64] = field(default_factory=T_BASE_OPTICAL.copy)

    @property
    def K(self) -> NDArray[np.float64]:
        """(3, 3) intrinsic matrix."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    def at_size(self, width: int, height: int) -> Camera:
        """The camera of an image with another number of pixels, as that of depth may have; itself without a size."""
        if not self.width or not self.height or (width, height) == (self.width, self.height):
            return self
        x, y = width / self.width, height / self.height
        centre = (self.cx + 0.5) * x - 0.5, (self.cy + 0.5) * y - 0.5
        return Camera(width, height, self.fx * x, self.fy * y, *centre, self.T_base_cam)

    def unproject(self, pixels: NDArray[np.floating], depth_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """Points in the optical frame, (N, 3) metres, of pixels (N, 2) at depth (N,) metres along z."""
        z = np.asarray(depth_m, dtype=np.float64)
        x = (pixels[:, 0] - self.cx) / self.fx * z
        y = (pixels[:, 1] - self.cy) / self.fy * z
        return np.column_stack([x, y, z])

    def project(self, points_cam: NDArray[np.floating]) -> NDArray[np.float64]:
        """Pixels (N, 2) of points (N, 3) in the optical frame; points with z <= 0 give NaN."""
        z = np.where(points_cam[:, 2] > 0, points_cam[:, 2], np.nan)
        u = self.fx * points_cam[:, 0] / z + self.cx
        v = self.fy * points_cam[:, 1] / z + self.cy
        return np.column_stack([u, v])
