"""Key points of an image with descriptors and depth, of the type that a parameter names."""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.feature_type import FeatureType, choose_feature_type
from slam.features.region import Wanted
from slam.geometry import transform
from slam.params import Params
from slam.types import Features, Frame

#: A depth is trusted when its 3x3 neighbourhood spreads less than this share of it.
_FLAT = 0.05


class Extractor:
    """Features of ``Vis/FeatureType`` for odometry and registration, or of ``Kp/DetectorStrategy`` for words."""

    def __init__(self, group: Literal["Vis", "Kp"] = "Vis") -> None:
        self._group = group
        self._number = -1
        self._type: FeatureType | None = None

    def extract(self, frame: Frame, params: Params) -> Features:
        """Up to ``Vis/MaxFeatures`` key points of a frame, strongest first; for words as many, or ``Kp/MaxFeatures``.

        Raises:
            ValueError: the type can't be extracted here (``Params`` refuses such numbers).
        """
        wanted: Wanted = params.Vis if self._group == "Vis" else params.Kp
        number = params.Vis.FeatureType if self._group == "Vis" else params.Kp.DetectorStrategy
        limit = max(wanted.MaxFeatures, params.Vis.MaxFeatures)
        if self._type is None or number != self._number:
            self._type, self._number = choose_feature_type(number), number
        gray: NDArray[np.uint8] = np.asarray(cv2.cvtColor(frame.image_bgr, cv2.COLOR_BGR2GRAY), np.uint8)
        found, descriptors = self._type.extract(gray, wanted, limit, params)
        return Features(
            pixels=found.pixels,
            sizes=found.sizes,
            angles=found.angles,
            responses=found.responses,
            octaves=found.octaves,
            descriptors=descriptors,
            points_base=_points_base(found.pixels, frame.depth_m, frame.camera, wanted),
        )


def _points_base(
    pixels: NDArray[np.float32], depth_m: NDArray[np.float32], camera: Camera, wanted: Wanted
) -> NDArray[np.float32]:
    """(N, 3) points in the base frame; NaN where depth is unknown, out of range, or on the edge of something."""
    depth = _sample(depth_m, pixels)
    good = depth > max(0.0, wanted.MinDepth)
    if wanted.MaxDepth > 0:
        good &= depth <= wanted.MaxDepth
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
