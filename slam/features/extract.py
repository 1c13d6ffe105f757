"""Key points of an image with binary descriptors and depth: GFTT corners described by ORB."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.features import corners
from slam.features.depth import points_base
from slam.params import Params
from slam.types import Features, Frame

_PATCH = 31
_BORDER = 20


class Extractor:
    """GFTT/ORB: Shi-Tomasi corners (1994), spread over the image, with upright ORB descriptors of 32 bytes."""

    def __init__(self) -> None:
        self._orb = cv2.ORB.create(nlevels=1, edgeThreshold=_BORDER - 1, patchSize=_PATCH)

    def extract(self, frame: Frame, params: Params) -> Features:
        """Up to ``Vis/MaxFeatures`` key points of a frame, strongest first."""
        gray: NDArray[np.uint8] = np.asarray(cv2.cvtColor(frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
        pixels, responses = _corners(gray, params)
        keypoints = [cv2.KeyPoint(x, y, _PATCH) for x, y in pixels.tolist()]
        kept, descriptors = self._orb.compute(gray, keypoints)
        if descriptors is None:
            kept, descriptors = (), np.zeros((0, 32), np.uint8)
        if len(kept) != len(pixels):
            raise AssertionError("ORB dropped key points that lie inside its border")
        count = len(pixels)
        return Features(
            pixels=pixels,
            sizes=np.full(count, _PATCH, np.float32),
            angles=np.full(count, -1.0, np.float32),
            responses=responses,
            octaves=np.zeros(count, np.int32),
            descriptors=np.asarray(descriptors, np.uint8),
            points_base=points_base(pixels, frame.depth_m, frame.camera, params),
        )


def _corners(gray: NDArray[np.uint8], params: Params) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    strength = np.asarray(cv2.cornerMinEigenVal(gray, params.GFTT.BlockSize), np.float32)
    threshold = params.GFTT.QualityLevel * float(strength.max())
    pixels, found = corners.local_maxima(strength, threshold, _BORDER)
    order = np.argsort(-found, kind="stable")
    rows = corners.spread(pixels, order, gray.shape, params.GFTT.MinDistance, params.Vis.MaxFeatures)
    return corners.refine(strength, pixels[rows]), found[rows]
