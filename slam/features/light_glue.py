"""Matching by the LightGlue network (Lindenberger et al. 2023), which OpenCV 5 runs from a file that the user names."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import ParameterError
from slam.features.networks import read_network
from slam.params import Params
from slam.types import Features

#: The number of ``Vis/CorNNType`` that asks for it.
LIGHT_GLUE = 6
_FEATURE_TYPES = (100, 101)


def check_light_glue(params: Params) -> None:
    """Reads the network where the parameters ask for it.

    Raises:
        ParameterError: the key points are of a type that no such network is made for, or the file can't be read.
    """
    if params.Vis.CorNNType != LIGHT_GLUE:
        return
    if params.Vis.FeatureType not in _FEATURE_TYPES:
        raise ParameterError(
            f"Vis/CorNNType={LIGHT_GLUE} (LightGlue) needs Vis/FeatureType 100 (ALIKED) or 101 (DISK),"
            f" not {params.Vis.FeatureType}"
        )
    _network(params.LightGlue.ModelPath, params.LightGlue.Threshold)


def match_light_glue(
    features_from: Features, camera_from: Camera, features_to: Features, camera_to: Camera, params: Params
) -> NDArray[np.int32]:
    """Matches (K, 2) int32 rows (from, to), ascending, of two images; no row is in two of them.

    Raises:
        ParameterError: the network can't be read, or was made for descriptors of another size.
    """
    if not len(features_from) or not len(features_to):
        return np.zeros((0, 2), np.int32)
    matcher = _network(params.LightGlue.ModelPath, params.LightGlue.Threshold)
    matcher.setPairInfo(
        features_from.pixels,
        features_to.pixels,
        (camera_from.width, camera_from.height),
        (camera_to.width, camera_to.height),
    )
    try:
        found = matcher.match(features_from.descriptors, features_to.descriptors)
    except cv2.error as error:
        columns = features_from.descriptors.shape[1]
        raise ParameterError(
            f"LightGlue/ModelPath={params.LightGlue.ModelPath}: the network can't match descriptors"
            f" of {columns} numbers ({error.err})"
        ) from error
    pairs = sorted((match.queryIdx, match.trainIdx) for match in found)
    return np.array(pairs, np.int32).reshape(-1, 2)


@lru_cache(maxsize=1)
def _network(path: str, threshold: float) -> Any:
    opencv: Any = cv2
    return read_network("LightGlue", path, lambda file: opencv.LightGlueMatcher.create(file, threshold))
