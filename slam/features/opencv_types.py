"""OpenCV's detectors and descriptors, made once for a set of parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.features.key_points import KeyPoints
from slam.features.region import Wanted, strongest
from slam.params import Params
from slam.types import Descriptors

#: Makes an OpenCV object that finds at most so many key points (0: all).
Maker = Callable[[int, Params], Any]


class Made:
    """The object of a maker; made anew only when what it is made from changes (BRISK's pattern takes 0.1 s)."""

    def __init__(self, make: Maker) -> None:
        self._make = make
        self._count, self._params = -1, Params()
        self._object: Any = None

    def get(self, count: int, params: Params) -> Any:
        """The object for these parameters."""
        if self._object is None or count != self._count or params is not self._params:
            self._object = self._make(count, params)
            self._count, self._params = count, params
        return self._object


class Both:
    """A type that finds and describes in one go: SIFT, ORB, BRISK, KAZE."""

    def __init__(self, make: Maker) -> None:
        self._made = Made(make)

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """Up to ``limit`` key points, strongest first, and their descriptors (N, B)."""
        plain = wanted.GridRows * wanted.GridCols == 1 and not any(float(w) for w in wanted.RoiRatios.split())
        opencv = self._made.get(limit if plain else 0, params)
        cv_points, raw = opencv.detectAndCompute(gray, None)
        found = KeyPoints.from_cv(cv_points)
        rows = strongest(found, gray.shape, wanted, limit)
        return found.take(rows), _typed(opencv, raw)[rows]


class Fast:
    """FAST corners (Rosten and Drummond 2006)."""

    def __init__(self) -> None:
        self._made = Made(
            lambda _, p: cv2.FastFeatureDetector.create(p.FAST.Threshold, nonmaxSuppression=p.FAST.NonmaxSuppression)
        )

    def detect(self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params) -> KeyPoints:
        """Up to ``limit`` corners, strongest first."""
        found = KeyPoints.from_cv(self._made.get(0, params).detect(gray, None))
        return found.take(strongest(found, gray.shape, wanted, limit))


class Descriptor:
    """A descriptor of key points that something else found."""

    def __init__(self, make: Maker) -> None:
        self._made = Made(make)

    def describe(
        self, gray: NDArray[np.uint8], found: KeyPoints, params: Params
    ) -> tuple[NDArray[np.integer], Descriptors]:
        """Rows of the key points that could be described (not too near the border), and their descriptors (N, B)."""
        opencv = self._made.get(0, params)
        kept, raw = opencv.compute(gray, found.to_cv())
        return np.array([k.class_id for k in kept], np.int64), _typed(opencv, raw)


def _typed(opencv: Any, raw: Any) -> Descriptors:
    if raw is None or len(raw) == 0:
        raw = np.zeros((0, opencv.descriptorSize()))
    return np.asarray(raw, np.float32) if opencv.descriptorType() == cv2.CV_32F else np.asarray(raw, np.uint8)


def make_orb(count: int, params: Params) -> Any:
    """ORB (Rublee 2011)."""
    p = params.ORB
    return cv2.ORB.create(
        nfeatures=count or _MANY,
        scaleFactor=p.ScaleFactor,
        nlevels=p.NLevels,
        edgeThreshold=p.EdgeThreshold,
        firstLevel=p.FirstLevel,
        scoreType=p.ScoreType,
        patchSize=p.PatchSize,
        fastThreshold=params.FAST.Threshold,
    )


def make_upright_orb(_count: int, params: Params) -> Any:
    """ORB's descriptor of corners of the image as it is."""
    return cv2.ORB.create(nlevels=1, edgeThreshold=params.ORB.EdgeThreshold, patchSize=params.ORB.PatchSize)


def make_sift(count: int, params: Params) -> Any:
    """SIFT (Lowe 2004)."""
    p = params.SIFT
    return cv2.SIFT.create(
        nfeatures=count,
        nOctaveLayers=p.NOctaveLayers,
        contrastThreshold=p.ContrastThreshold,
        edgeThreshold=p.EdgeThreshold,
        sigma=p.Sigma,
        enable_precise_upscale=p.PreciseUpscale,
    )


def make_brisk(_count: int, params: Params) -> Any:
    """BRISK (Leutenegger 2011)."""
    p = params.BRISK
    return _contrib("BRISK").create(p.Thresh, p.Octaves, p.PatternScale)


def make_kaze(_count: int, params: Params) -> Any:
    """KAZE (Alcantarilla 2012)."""
    p = params.KAZE
    return _contrib("KAZE").create(p.Extended, p.Upright, p.Threshold, p.NOctaves, p.NOctaveLayers, p.Diffusivity)


def make_brief(_count: int, params: Params) -> Any:
    """BRIEF (Calonder 2010)."""
    return _contrib("BriefDescriptorExtractor").create(params.BRIEF.Bytes)


def make_freak(_count: int, params: Params) -> Any:
    """FREAK (Alahi 2012)."""
    p = params.FREAK
    return _contrib("FREAK").create(p.OrientationNormalized, p.ScaleNormalized, p.PatternScale, p.NOctaves)


def make_daisy(_count: int, _params: Params) -> Any:
    """DAISY (Tola 2010), 200 numbers."""
    return _contrib("DAISY").create()


_MANY = 100_000


def _contrib(name: str) -> Any:
    """A class that OpenCV 5 keeps in ``xfeatures2d``, and 4 partly in the main module."""
    extra: Any = cv2.xfeatures2d
    return getattr(extra, name, None) or getattr(cv2, name)
