"""What a structured-light depth camera makes of exact depth."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

BASELINE_M = 0.075
#: Focal length times baseline of a Kinect in pixel metres; it measures disparity = this / depth in eighths of a pixel
#: (Khoshelham and Oude Elberink 2012, section 2), which makes both steps and noise grow with depth squared.
FOCAL_BASELINE = 580.0 * BASELINE_M
STEPS_PER_PIXEL = 8.0
#: Deviation of the disparity in pixels: 1.4 mm at 1 m, 3.6 cm at 5 m (ibid., section 5).
NOISE_PX = 0.062
RANGE_M = (0.4, 8.0)


@njit(cache=True, nogil=True)
def measure(
    inverse_z: NDArray[np.float64],
    noise: NDArray[np.float32],
    start: int,
    focal_px: float,
    depth_m: NDArray[np.float32],
) -> None:
    """Fill ``depth_m`` (H, W) float32 from exact 1/z (H, W); 0 is unknown.

    Noise comes from a table of standard normal numbers (its length a power of two), begun at ``start``.
    The projector stands right of the camera, so that a strip left of each near object lies in its shadow.
    """
    height, width = inverse_z.shape
    shift = focal_px * BASELINE_M
    mask = len(noise) - 1
    for y in range(height):
        lit_up_to = np.inf
        for x in range(width - 1, -1, -1):
            exact = inverse_z[y, x]
            depth_m[y, x] = 0.0
            seen_by_projector = x - shift * exact
            if seen_by_projector > lit_up_to + 1.0:
                continue
            lit_up_to = min(lit_up_to, seen_by_projector)
            disparity = FOCAL_BASELINE * exact + NOISE_PX * noise[(start + y * width + x) & mask]
            steps = np.rint(disparity * STEPS_PER_PIXEL)
            if steps > 0:
                z = FOCAL_BASELINE * STEPS_PER_PIXEL / steps
                if RANGE_M[0] <= z <= RANGE_M[1]:
                    depth_m[y, x] = z
