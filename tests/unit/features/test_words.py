"""Which key points become words."""

from __future__ import annotations

import numpy as np
import pytest

from slam.features.extract import Extractor
from slam.features.words import NodeFeatures
from slam.params import Params, Value
from slam.types import Features
from tests.tours import sparse

FRAME = sparse()[0]


def chosen(**changes: Value) -> tuple[Features, Features, int]:
    """Odometry's features, those of the node, and how many become words."""
    params = Params().changed({name.replace("_", "/"): value for name, value in changes.items()})
    odometry = Extractor().extract(FRAME, params)
    return odometry, *NodeFeatures().of(FRAME, odometry, params)


def test_words_are_odometrys_best_features_by_default() -> None:
    odometry, features, count = chosen()
    assert features is odometry
    assert count == min(500, len(odometry))
    assert chosen(Kp_MaxFeatures=60)[2] == 60


@pytest.mark.parametrize(
    "changes", [{"Kp_DetectorStrategy": 1}, {"Mem_UseOdomFeatures": False, "Kp_SubPixIterations": 5}]
)
def test_words_of_their_own_are_extracted_for_themselves(changes: dict[str, Value]) -> None:
    odometry, features, count = chosen(**changes, Kp_MaxFeatures=100)
    params = Params().changed({name.replace("_", "/"): value for name, value in changes.items()})
    own = Extractor("Kp").extract(FRAME, params)
    np.testing.assert_array_equal(features.pixels, own.pixels)
    assert count == 100 < len(features), "the others are kept for registration"
    assert len(features) != len(odometry) or not np.array_equal(features.pixels, odometry.pixels)


def test_words_lie_in_their_range_of_depth_and_the_rest_is_kept() -> None:
    seen = Extractor().extract(FRAME, Params()).points_base[:, 0]  # forward is the camera's axis
    near, far = (float(depth) for depth in np.nanpercentile(seen, [30, 70]))
    odometry, features, count = chosen(Kp_MinDepth=near, Kp_MaxDepth=far)
    depths = features.points_base[:, 0]
    assert 0 < count < len(features) == len(odometry)
    assert (depths[:count] > near - 1e-6).all() and (depths[:count] <= far + 1e-6).all()
    rest = depths[count:]
    assert (rest < near + 1e-6).any() and (rest > far).any() and not ((rest > near + 1e-6) & (rest < far - 1e-6)).any()
    assert sorted(features.responses.tolist()) == sorted(odometry.responses.tolist())


def test_words_keep_out_of_their_border_and_share_their_grid() -> None:
    _, features, count = chosen(Kp_RoiRatios="0.5 0 0 0", Kp_GridRows=2, Kp_MaxFeatures=40)
    words = features.pixels[:count]
    assert (words[:, 0] >= 160).all()
    assert np.bincount((words[:, 1] >= 120).astype(int)).tolist() == [20, 20]
    halves = [features.responses[:count][words[:, 1] < 120], features.responses[:count][words[:, 1] >= 120]]
    for half in halves:
        assert (np.diff(half) <= 0).all()
