"""The feature types by their numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from slam.features.gftt import Gftt
from slam.features.key_points import KeyPoints
from slam.features.networks import Network, make_aliked, make_disk
from slam.features.opencv_types import (
    Both,
    Descriptor,
    Fast,
    make_brief,
    make_brisk,
    make_daisy,
    make_freak,
    make_kaze,
    make_orb,
    make_sift,
    make_upright_orb,
)
from slam.features.orb_octree import OrbOctree
from slam.features.region import Wanted, refined
from slam.features.surf import Surf, SurfDetector
from slam.params import Params
from slam.params.feature_types import checked_feature_type
from slam.types import Descriptors

#: FREAK's smallest key point, for corners without a size of their own.
_CORNER_PX = 7.0
_SMALLEST = 1e-7


class FeatureType(Protocol):
    """Finds and describes key points."""

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """Up to ``limit`` key points of a grey image, strongest first, and their descriptors (N, B)."""
        ...


class _Detector(Protocol):
    def detect(self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params) -> KeyPoints: ...


class DetectThenDescribe:
    """Key points of one kind with descriptors of another."""

    def __init__(self, detector: _Detector, descriptor: Descriptor) -> None:
        self._detector, self._descriptor = detector, descriptor

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """Those that could be described."""
        found = refined(gray, self._detector.detect(gray, wanted, limit, params), wanted)
        rows, descriptors = self._descriptor.describe(gray, found, params)
        # OpenCV leaves some out, and sorts those of a pyramid by level: strongest first again.
        order = np.argsort(rows, kind="stable")
        return found.take(rows[order]), descriptors[order]


class Sift:
    """SIFT, with the roots of the normalised numbers on request (Arandjelovic and Zisserman 2012)."""

    def __init__(self) -> None:
        self._plain = Both(make_sift)

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """As any type that does both."""
        found, descriptors = self._plain.extract(gray, wanted, limit, params)
        if params.SIFT.RootSIFT:
            sums = np.maximum(descriptors.sum(axis=1, keepdims=True), _SMALLEST)
            descriptors = np.sqrt(descriptors / sums).astype(np.float32)
        return found, descriptors


_TYPES: dict[int, Callable[[], FeatureType]] = {
    0: Surf,
    1: Sift,
    2: lambda: Both(make_orb),
    3: lambda: DetectThenDescribe(Fast(), Descriptor(make_freak)),
    4: lambda: DetectThenDescribe(Fast(), Descriptor(make_brief)),
    5: lambda: DetectThenDescribe(Gftt(_CORNER_PX), Descriptor(make_freak)),
    6: lambda: DetectThenDescribe(Gftt(_CORNER_PX), Descriptor(make_brief)),
    7: lambda: Both(make_brisk),
    8: lambda: DetectThenDescribe(Gftt(), Descriptor(make_upright_orb)),
    9: lambda: Both(make_kaze),
    10: lambda: DetectThenDescribe(OrbOctree(), Descriptor(make_orb)),
    12: lambda: DetectThenDescribe(SurfDetector(), Descriptor(make_freak)),
    13: lambda: DetectThenDescribe(Gftt(_CORNER_PX), Descriptor(make_daisy)),
    14: lambda: DetectThenDescribe(SurfDetector(), Descriptor(make_daisy)),
    100: lambda: Network(make_aliked),
    101: lambda: Network(make_disk),
}


def choose_feature_type(number: int) -> FeatureType:
    """The type of ``Vis/FeatureType`` or ``Kp/DetectorStrategy``.

    Raises:
        ValueError: it can't be extracted here.
    """
    return _TYPES[checked_feature_type(number)]()
