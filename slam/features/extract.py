"""Key points of an image with descriptors and depth, of the type that a parameter names."""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.features.depth import points_base
from slam.features.feature_type import FeatureType, choose_feature_type
from slam.features.region import Wanted
from slam.params import Params
from slam.types import Descriptors, Features, Frame


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
            points_base=points_base(found.pixels, frame.depth_m, frame.camera, wanted),
        )


def kind_of_words(params: Params) -> Descriptors:
    """No descriptors (0, B), but of the type and width that ``Kp/DetectorStrategy`` makes: found by making some."""
    noise = np.random.default_rng(0).integers(0, 256, (160, 160), np.uint8)
    return choose_feature_type(params.Kp.DetectorStrategy).extract(noise, params.Kp, 50, params)[1][:0]
