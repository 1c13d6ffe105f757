"""From stored images to those of the pinhole camera."""

from __future__ import annotations

from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.sensors.calibration import Calibration


class Rectifier(Protocol):
    """Turns a stored image pair into one of the pinhole camera."""

    def color(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Rectified (H, W, 3) colour image."""
        ...

    def depth(self, depth: NDArray[np.uint16]) -> NDArray[np.uint16]:
        """Rectified (H, W) depth image, 0 where the stored one has nothing."""
        ...


def make_rectifier(calibration: Calibration) -> Rectifier:
    """The rectifier of a calibration; images without distortion pass unchanged."""
    return _Remap(calibration) if calibration.distortion else _Unchanged()


class _Unchanged:
    def color(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        return image

    def depth(self, depth: NDArray[np.uint16]) -> NDArray[np.uint16]:
        return depth


class _Remap:
    """Same K before and after, as OpenCV's undistort: a pixel moves only by its distortion."""

    def __init__(self, calibration: Calibration) -> None:
        camera = calibration.camera
        coefficients = np.array(calibration.distortion)
        size = (camera.width, camera.height)
        x, y = cv2.initUndistortRectifyMap(camera.K, coefficients, np.eye(3), camera.K, size, cv2.CV_32FC1)
        self._smooth = cv2.convertMaps(x, y, cv2.CV_16SC2)
        self._nearest = x, y

    def color(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        # The rim repeats the last pixel: a black one would have corners of its own.
        out = cv2.remap(image, *self._smooth, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(out, dtype=np.uint8)

    def depth(self, depth: NDArray[np.uint16]) -> NDArray[np.uint16]:
        # Nearest: a mean across an edge would be a point in mid air.
        out = cv2.remap(depth, *self._nearest, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT)
        return np.asarray(out, dtype=np.uint16)
