"""The start of real and rendered sequences: tracked without a gap, and as accurately as ever."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import pytest

from slam.params import Params
from slam.run import ate_rmse_m
from slam.sensors import open_source
from slam.slam import Slam


@pytest.mark.parametrize(
    ("name", "frames", "nodes", "most_m"),
    [
        ("tum_fr1_xyz_excerpt", 60, 4, 0.018),  # a hand-held Kinect, two seconds
        ("toyroom", 60, 4, 0.006),  # rendered, two seconds
        ("hololens_tour", 40, 12, 0.035),  # wide gaps between the frames, eight seconds
    ],
)
def test_the_start_of_a_sequence(shared_data: Path, name: str, frames: int, nodes: int, most_m: float) -> None:
    slam = Slam(Params())
    for frame in islice(open_source(shared_data / name), frames):
        assert slam.process(frame).T_map_base is not None, f"lost at {frame.index}"
    error = ate_rmse_m(slam)
    assert error is not None
    assert error < most_m
    assert len(slam.graph) == nodes
    assert len(slam.graph.links) == nodes - 1
