"""The optimised poses of maps that RTAB-Map 0.23.8 built (GTSAM) come out of their links here too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader
from slam.geometry import between, inverse, rotation_angle, translation_norm
from slam.graph import PoseGraph, max_error, optimize
from slam.params import Params


@pytest.mark.parametrize("name", ["toyroom", "tum_fr1_xyz_excerpt"])
@pytest.mark.parametrize("from_odometry", [False, True])
def test_optimised_poses_agree_with_rtabmap(shared_data: Path, name: str, from_odometry: bool) -> None:
    reader = MapReader(shared_data / "rtabmap_db" / f"cpp_0.23.8_{name}.db")
    graph, theirs = PoseGraph.from_reader(reader), reader.poses()
    if from_odometry:
        graph.poses = dict(graph.T_odom)
    assert graph.poses.keys() == theirs.keys()
    ours = optimize(graph, Params()).poses
    T = theirs[min(theirs)] @ inverse(ours[min(ours)])
    apart = [between(theirs[i], T @ ours[i]) for i in theirs]
    assert max(translation_norm(d) for d in apart) < 0.001
    assert np.degrees(max(rotation_angle(d) for d in apart)) < 0.02
    assert max_error(graph, ours).ratio < 3
