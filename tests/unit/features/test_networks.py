"""Features of networks: the file that is named is read, and what the network says is kept."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from slam.errors import ParameterError
from slam.features.extract import Extractor
from slam.features.files import check_files
from slam.params import Params, Value
from tests.tours import sparse

pytestmark = pytest.mark.skipif(not hasattr(cv2, "ALIKED"), reason="needs OpenCV 5")
NAMES = {100: "ALIKED", 101: "DISK"}


class StandIn:
    """What OpenCV's network classes do, but for the network: SIFT's key points and unit descriptors."""

    asked: list[tuple[str, int]]

    def __init__(self) -> None:
        self.asked = []

    def create(self, path: str, maxKeypoints: int = -1) -> StandIn:
        self.asked.append((path, maxKeypoints))
        return self

    def detectAndCompute(self, image: Any, mask: Any) -> tuple[Any, Any]:
        assert image.shape == (240, 320, 3), "networks are made for colour"
        points, numbers = cv2.SIFT.create(400).detectAndCompute(image[:, :, 0], mask)
        return points, numbers / np.linalg.norm(numbers, axis=1, keepdims=True)

    def descriptorSize(self) -> int:
        return 128

    def descriptorType(self) -> int:
        return cv2.CV_32F


def asking(number: int, **changes: Value) -> Params:
    return Params().changed({"Vis/FeatureType": number, **changes})


@pytest.mark.parametrize("number", NAMES)
def test_a_network_gives_key_points_and_descriptors(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    network = StandIn()
    monkeypatch.setattr(cv2, NAMES[number], network)
    params = asking(number, **{f"{NAMES[number]}/ModelPath": "net.onnx", "Vis/MaxFeatures": 150})
    extractor = Extractor()
    for _ in range(2):
        found = extractor.extract(sparse()[0], params)
    assert network.asked == [("net.onnx", 150 if number == 101 else -1)], "read once"
    assert len(found) == 150
    assert (found.descriptors.dtype.name, found.descriptors.shape[1]) == ("float32", 128)
    assert (np.diff(found.responses) <= 0).all()


@pytest.mark.parametrize("number", NAMES)
def test_without_a_file_a_network_is_refused(number: int, tmp_path: Path) -> None:
    name = NAMES[number]
    with pytest.raises(ParameterError, match=f"{name} features need {name}/ModelPath"):
        check_files(asking(number))
    none = tmp_path / "none.onnx"
    with pytest.raises(ParameterError, match=f"{name}/ModelPath={none}: OpenCV can't read this network"):
        check_files(asking(number, **{f"{name}/ModelPath": str(none)}))


def test_without_networks_nothing_is_read() -> None:
    check_files(Params())
