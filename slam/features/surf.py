"""SURF (Bay 2008): OpenCV's wheels are built without it, so that blobs are found here and described by mahotas."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.features.fast_hessian import blobs
from slam.features.key_points import KeyPoints
from slam.features.region import Wanted, strongest
from slam.params import Params
from slam.types import Descriptors

#: A filter of this side stands for a Gaussian of _SIGMA pixels.
_SIDE, _SIGMA = 9.0, 1.2
_NUMBERS = 64


class SurfDetector:
    """Blobs, upright until they are described."""

    def detect(self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params) -> KeyPoints:
        """Up to ``limit`` blobs, strongest first."""
        found, _ = _detect(gray, wanted, limit, params)
        return found


class Surf:
    """Blobs with 64 numbers, turned with the image."""

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """Up to ``limit`` blobs, strongest first, and their descriptors (N, 64); those near the border are left out."""
        # mahotas also has a detector, but it moves key points to the wrong side of the pixel (1.4.19).
        from mahotas.features import surf  # an image library that only this type needs

        found, signs = _detect(gray, wanted, limit, params)
        if len(found) == 0:
            return found, np.zeros((0, _NUMBERS), np.float32)
        scales = found.sizes * (_SIGMA / _SIDE)
        rows = np.arange(len(found), dtype=np.float64)
        # The score is handed through unused: it carries the row, for points near the border are dropped.
        points = np.column_stack([found.pixels[:, ::-1], scales, rows, signs]).astype(np.float64)
        table = np.asarray(surf.descriptors(gray, points), np.float64)
        kept = table[:, 3].astype(np.int64)
        angles = np.degrees(table[:, 5]) % 360.0
        described = replace(found.take(kept), angles=angles.astype(np.float32))
        return described, table[:, 6:].astype(np.float32)


def _detect(
    gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
) -> tuple[KeyPoints, NDArray[np.float64]]:
    p = params.SURF
    table = blobs(gray, octaves=p.Octaves, layers=p.OctaveLayers, threshold=p.HessianThreshold)
    found = KeyPoints(
        pixels=table[:, :2].astype(np.float32),
        sizes=table[:, 2].astype(np.float32),
        angles=np.full(len(table), -1.0, np.float32),
        responses=table[:, 3].astype(np.float32),
        octaves=np.zeros(len(table), np.int32),
    )
    rows = strongest(found, gray.shape, wanted, limit)
    return found.take(rows), table[rows, 4]
