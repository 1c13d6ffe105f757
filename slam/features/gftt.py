"""Good features to track: corners by the smaller eigenvalue (Shi and Tomasi 1994) or Harris's measure."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.features import corners
from slam.features.key_points import KeyPoints
from slam.features.min_eigenvalue import min_eigenvalue
from slam.features.region import Region, Wanted
from slam.params import Params

_HARRIS_APERTURE = 3


class Gftt:
    """Corners that keep ``GFTT/MinDistance`` from each other, to a fraction of a pixel.

    Args:
        size: diameter in pixels that the descriptor takes; None for ``ORB/PatchSize``.
    """

    def __init__(self, size: float | None = None) -> None:
        self._size = size
        self._strength: NDArray[np.float32] | None = None

    def detect(self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params) -> KeyPoints:
        """Up to ``limit`` corners, strongest first."""
        strength = self._strength_of(gray, params)
        region = Region.of(gray.shape, wanted)
        border = params.ORB.EdgeThreshold + 1
        if region == Region(0, 0, gray.shape[1], gray.shape[0], 1, 1):
            pixels, found = corners.local_maxima(strength, params.GFTT.QualityLevel * float(strength.max()), border)
        else:
            pixels, found = _by_cell(*corners.local_maxima(strength, 0.0, border), region, params)
        order = np.argsort(-found, kind="stable")
        most = limit if region.cells == 1 else max(1, len(found))
        rows = corners.spread(pixels, order, gray.shape, params.GFTT.MinDistance, most)
        rows = region.share(rows, pixels, limit)
        size = params.ORB.PatchSize if self._size is None else self._size
        return KeyPoints.upright(corners.refine(strength, pixels[rows]), found[rows], size)

    def _strength_of(self, gray: NDArray[np.uint8], params: Params) -> NDArray[np.float32]:
        if params.GFTT.UseHarrisDetector:
            measure = cv2.cornerHarris(gray, params.GFTT.BlockSize, _HARRIS_APERTURE, params.GFTT.K)
            return np.asarray(measure, np.float32)
        self._strength = min_eigenvalue(gray, params.GFTT.BlockSize, self._strength)
        return self._strength


def _by_cell(
    pixels: NDArray[np.int32], found: NDArray[np.float32], region: Region, params: Params
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """The corners of the region that reach ``GFTT/QualityLevel`` of the strongest in their cell."""
    inside = region.inside(pixels)
    pixels, found = pixels[inside], found[inside]
    cell = region.cell_of(pixels)
    best = np.zeros(region.cells, np.float32)
    np.maximum.at(best, cell, found)
    good = found > params.GFTT.QualityLevel * best[cell]
    return pixels[good], found[good]
