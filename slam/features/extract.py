"""Key points of an image with binary descriptors and depth: GFTT corners described by ORB."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features import corners
from slam.geometry import transform
from slam.params import Params
from slam.types import Features, Frame

_PATCH = 31
_BORDER = 20
#: A depth is trusted when its 3x3 neighbourhood spreads less than this share of it.
_FLAT = 0.05


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
            points_base=_points_base(pixels, frame.depth_m, frame.camera, params),
        )


def _corners(gray: NDArray[np.uint8], params: Params) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    strength = np.asarray(cv2.cornerMinEigenVal(gray, params.GFTT.BlockSize), np.float32)
    threshold = params.GFTT.QualityLevel * float(strength.max())
    pixels, found = corners.local_maxima(strength, threshold, _BORDER)
    order = np.argsort(-found, kind="stable")
    rows = corners.spread(pixels, order, gray.shape, params.GFTT.MinDistance, params.Vis.MaxFeatures)
    return corners.refine(strength, pixels[rows]), found[rows]


def _points_base(
    pixels: NDArray[np.float32], depth_m: NDArray[np.float32], camera: Camera, params: Params
) -> NDArray[np.float32]:
    """(N, 3) points in the base frame; NaN where depth is unknown, out of range, or on the edge of something."""
    depth = _sample(depth_m, pixels)
    good = depth > max(0.0, params.Vis.MinDepth)
    if params.Vis.MaxDepth > 0:
        good &= depth <= params.Vis.MaxDepth
    points_cam = camera.unproject(pixels, np.where(good, depth, np.nan))
    return transform(camera.T_base_cam, points_cam).astype(np.float32)


def _sample(depth_m: NDArray[np.float32], pixels: NDArray[np.float32]) -> NDArray[np.float64]:
    """Depth (N,) at or next to each pixel; 0 where it is unknown or changes too fast to be trusted."""
    x, y = np.rint(pixels).astype(np.int32).T
    patch = np.stack([depth_m[y + dy, x + dx] for dy in (-1, 0, 1) for dx in (-1, 0, 1)])
    patch[patch <= 0] = np.nan
    known = np.isfinite(patch).sum(axis=0)
    patch[:, known == 0] = 0.0
    middle = np.where(np.isfinite(patch[4]), patch[4], np.nanmedian(patch, axis=0))
    flat = np.nanmax(patch, axis=0) - np.nanmin(patch, axis=0) <= _FLAT * middle
    return np.where(flat & (known > 0), middle, 0.0).astype(np.float64)
