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
from slam.features.light_glue import check_light_glue
from slam.params import Params, Value
from slam.registration.visual import register
from tests.tours import sparse

pytestmark = pytest.mark.skipif(not hasattr(cv2, "ALIKED"), reason="needs OpenCV 5")
NAMES = {100: "ALIKED", 101: "DISK"}


class Glue:
    """What OpenCV's LightGlue does, but for the network: equal descriptors match."""

    asked: list[tuple[str, float]]
    sizes: tuple[Any, ...]

    def __init__(self) -> None:
        self.asked = []

    def create(self, path: str, threshold: float) -> Glue:
        self.asked.append((path, threshold))
        return self

    def setPairInfo(self, pixels_from: Any, pixels_to: Any, size_from: Any, size_to: Any) -> None:
        assert pixels_from.shape[1] == pixels_to.shape[1] == 2
        self.sizes = size_from, size_to

    def match(self, descriptors_from: Any, descriptors_to: Any) -> Any:
        near = (descriptors_from @ descriptors_to.T) > 0.9999
        return [cv2.DMatch(int(i), int(j), 0.0) for i, j in np.argwhere(near)][::-1]


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
    with pytest.raises(ParameterError, match=f"{name} needs {name}/ModelPath"):
        check_files(asking(number))
    none = tmp_path / "none.onnx"
    with pytest.raises(ParameterError, match=f"{name}/ModelPath={none}: OpenCV can't read this network"):
        check_files(asking(number, **{f"{name}/ModelPath": str(none)}))


def test_without_networks_nothing_is_read() -> None:
    check_files(Params())


def test_light_glue_matches_where_there_is_no_guess(monkeypatch: pytest.MonkeyPatch) -> None:
    network, glue = StandIn(), Glue()
    monkeypatch.setattr(cv2, "ALIKED", network)
    monkeypatch.setattr(cv2, "LightGlueMatcher", glue)
    named: dict[str, Value] = {"ALIKED/ModelPath": "net.onnx", "LightGlue/ModelPath": "glue.onnx"}
    params = asking(100, **named, **{"Vis/CorNNType": 6, "LightGlue/Threshold": 0.2, "Vis/MaxFeatures": 150})
    check_files(params)
    frame = sparse()[0]
    features = Extractor().extract(frame, params)
    order = np.random.default_rng(1).permutation(len(features))
    found = register(features, features.take(order), frame.camera, params)
    assert glue.asked == [("glue.onnx", 0.2)], "read once"
    assert glue.sizes == ((320, 240), (320, 240))
    assert found.refusal is None
    assert found.T_from_to is not None
    np.testing.assert_allclose(found.T_from_to, np.eye(4), atol=1e-3)
    np.testing.assert_array_equal(order[found.matches[:, 1]], found.matches[:, 0])


def test_light_glue_is_refused_without_a_file_or_for_other_features(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match=r"needs Vis/FeatureType 100 \(ALIKED\) or 101 \(DISK\), not 8"):
        check_files(Params().changed({"Vis/CorNNType": 6, "LightGlue/ModelPath": "glue.onnx"}))
    none = tmp_path / "none.onnx"
    with pytest.raises(ParameterError, match=f"LightGlue/ModelPath={none}: OpenCV can't read this network"):
        check_light_glue(asking(100, **{"Vis/CorNNType": 6, "LightGlue/ModelPath": str(none)}))
    with pytest.raises(ParameterError, match="LightGlue needs LightGlue/ModelPath"):
        check_light_glue(asking(101, **{"Vis/CorNNType": 6}))
