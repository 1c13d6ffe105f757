"""Features of networks that OpenCV 5 runs, from an ONNX file that the user names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.errors import ParameterError
from slam.features.key_points import KeyPoints
from slam.features.opencv_types import Both, Maker
from slam.features.region import Wanted
from slam.params import Params
from slam.types import Descriptors


class Network:
    """Key points and 128 numbers each from a network, which sees the grey image as a colour one."""

    def __init__(self, make: Maker) -> None:
        self._both = Both(make)

    def extract(
        self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params
    ) -> tuple[KeyPoints, Descriptors]:
        """Up to ``limit`` key points, strongest first, and their descriptors (N, 128).

        Raises:
            ParameterError: the file of the network can't be read.
        """
        image = np.asarray(cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR), np.uint8)
        return self._both.extract(image, wanted, limit, params)


def make_aliked(_count: int, params: Params) -> Any:
    """ALIKED (Zhao 2023); the network's file says how many key points it gives."""
    opencv: Any = cv2
    return read_network("ALIKED", params.ALIKED.ModelPath, lambda path: opencv.ALIKED.create(path))


def make_disk(count: int, params: Params) -> Any:
    """DISK (Tyszkiewicz 2020)."""
    opencv: Any = cv2
    return read_network("DISK", params.DISK.ModelPath, lambda path: opencv.DISK.create(path, maxKeypoints=count or -1))


def read_network(name: str, path: str, create: Callable[[str], Any]) -> Any:
    """What ``create`` makes of the file that the parameter ``name``/ModelPath names.

    Raises:
        ParameterError: it names none, or OpenCV can't read it.
    """
    if not path:
        raise ParameterError(f"{name} needs {name}/ModelPath: the ONNX file of the network")
    try:
        return create(path)
    except cv2.error as error:
        raise ParameterError(f"{name}/ModelPath={path}: OpenCV can't read this network ({error.err})") from error
