"""Each feature type tracks the rendered tour and closes its loops; words may be of another type than odometry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.geometry import between
from slam.params import Value
from slam.params.feature_types import FEATURE_TYPES
from slam.slam import Slam
from slam.types import Update
from tests.tours import EVERY, fed, there_and_back

BASE = EVERY.changed({"Mem/STMSize": 2, "Vis/MaxFeatures": 600, "Kp/MaxFeatures": 300})
WAY = 6


def drift_m(updates: list[Update]) -> float:
    """Distance from the true pose at the turning point, from the first pose."""
    way = there_and_back(WAY)
    T_map, truth = updates[WAY - 1].odometry.T_odom_base, [way[k].T_world_base for k in (0, WAY - 1)]
    first = updates[0].odometry.T_odom_base
    assert T_map is not None and first is not None and truth[0] is not None and truth[1] is not None
    error = between(between(truth[0], truth[1]), between(first, T_map))
    return float(np.linalg.norm(error[:3, 3]))


@pytest.mark.parametrize("number", FEATURE_TYPES)
def test_a_type_tracks_and_closes_loops(number: int) -> None:
    slam = Slam(BASE.changed({"Vis/FeatureType": number, "Kp/DetectorStrategy": number}))
    updates = fed(slam, there_and_back(WAY))
    assert [u.frame_index for u in updates if u.odometry.T_odom_base is None] == []
    assert drift_m(updates) < 0.05
    loops = [c for u in updates for c in u.candidates if c.refusal is None]
    assert any(c.from_id <= WAY for c in loops), "also between images that are not the same"
    way = there_and_back(WAY)
    seen = {u.node.id: way[u.frame_index].T_world_base for u in updates if u.node is not None}
    for loop in loops:
        T_world_from, T_world_to = seen[loop.from_id], seen[loop.to_id]
        assert T_world_from is not None and T_world_to is not None
        assert loop.T_from_to is not None and loop.information is not None
        error = between(between(T_world_from, T_world_to), loop.T_from_to)
        assert np.linalg.norm(error[:3, 3]) < 3.0 / np.sqrt(loop.information[0, 0])


@pytest.mark.parametrize("changes", [{"Kp/DetectorStrategy": 1}, {"Vis/FeatureType": 1}])
def test_words_of_another_type_go_to_the_file_and_come_back(tmp_path: Path, changes: dict[str, Value]) -> None:
    params = BASE.changed({**changes, "Rtabmap/MemoryThr": 2})
    path = tmp_path / "map.db"
    slam = Slam(params, MapWriter.create(path, params, seed=0, source="tour:"))
    updates = fed(slam, there_and_back(WAY))
    slam.close()
    assert any(c.refusal is None for u in updates for c in u.candidates)
    assert sum(u.statistics.get("Memory/Signatures_retrieved/", 0.0) for u in updates) > 0, "some came back from LTM"
    reader = MapReader(path)
    kind = ("float32", 128) if params.Kp.DetectorStrategy == 1 else ("uint8", 32)
    features, word_ids = reader.features(1)
    for descriptors in (features.descriptors, reader.words().descriptors):
        assert (descriptors.dtype.name, descriptors.shape[1]) == kind
    assert (word_ids > 0).sum() <= 300 < len(features)
