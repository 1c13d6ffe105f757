"""Depth of a rectified stereo pair, by semi-global matching."""

from __future__ import annotations

from typing import cast

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.errors import SourceError

#: Disparities that are looked for, as a share of the image's width, in steps of 16 as OpenCV wants them.
_SHARE, _STEP = 0.2, 16
_BLOCK = 5
#: OpenCV's fixed point numbers have four bits after the point.
_FRACTION = np.float32(16.0)


def stereo_depth(left: NDArray[np.uint8], right: NDArray[np.uint8], fx: float, baseline: float) -> NDArray[np.float32]:
    """Depth (H, W) in metres along the left camera's axis, 0 where unknown.

    Args:
        left: (H, W, 3) or (H, W) rectified image.
        right: of the same size.
        fx: focal length in pixels of these images.
        baseline: metres between the cameras.

    Raises:
        SourceError: the images differ in size, or the baseline is not positive.
    """
    if left.shape[:2] != right.shape[:2]:
        raise SourceError(f"left image of {left.shape[:2]} and right image of {right.shape[:2]}: one size is needed")
    if baseline <= 0:
        raise SourceError(f"baseline of {baseline:g} m: a stereo pair has its right camera on the right, more than 0")
    count = _STEP * max(1, round(_SHARE * left.shape[1] / _STEP))
    area = _BLOCK * _BLOCK
    matcher = cv2.StereoSGBM.create(
        numDisparities=count,
        blockSize=_BLOCK,
        P1=8 * area,
        P2=32 * area,
        disp12MaxDiff=1,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=2,
    )
    disparity = cast("NDArray[np.int16]", matcher.compute(_gray(left), _gray(right))).astype(np.float32) / _FRACTION
    known = disparity > 0
    return np.where(known, np.float32(fx * baseline) / np.where(known, disparity, 1.0), 0.0).astype(np.float32)


def _gray(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return cast("NDArray[np.uint8]", cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)) if image.ndim == 3 else image
