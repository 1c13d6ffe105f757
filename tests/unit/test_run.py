"""A whole run: every frame once and in order, and a summary that counts what happened."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slam.camera import Camera
from slam.database import MapReader, MapWriter
from slam.run import Tally, ate_rmse_m, peak_rss_mb, run
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Frame, LinkType, Update
from tests.tours import EVERY, covered, mapped, sparse, there_and_back


class Recorded:
    """A source of frames that are there already."""

    live = False
    name = "recorded"

    def __init__(self, frames: list[Frame]) -> None:
        self._frames = frames
        self.camera: Camera = frames[0].camera

    def __len__(self) -> int:
        return len(self._frames)

    def __iter__(self) -> Iterator[Frame]:
        return iter(self._frames)


def test_every_frame_is_handed_on_once_and_in_order() -> None:
    slam, seen = Slam(EVERY), list[Update]()
    tally = run(Recorded(list(sparse()[:5])), slam, seen.append)
    assert [update.frame_index for update in seen] == [0, 1, 2, 3, 4]
    assert tally.frames == 5
    assert len(slam.frames) == 5


def test_a_source_by_name_is_run_to_its_end() -> None:
    slam, seen = Slam(EVERY), list[Update]()
    tally = run(open_source("tour:width=160,height=120,fps=5,frames=4"), slam, seen.append)
    assert tally.frames == len(seen) == 4


def test_the_summary_counts_what_the_map_has(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    slam = Slam(EVERY, MapWriter.create(path, EVERY, seed=5, source="recorded"), seed=5)
    frames, seen = covered(there_and_back(14), [3]), list[Update]()
    tally = run(Recorded(frames), slam, seen.append)
    slam.close()
    summary = tally.summary(slam, seed=5, path=path)
    assert json.loads(json.dumps(summary)) == summary
    candidates = [c for update in seen for c in update.candidates]
    accepted = [c for c in candidates if c.refusal is None]
    assert summary["frames"] == len(frames)
    assert summary["lost_frames"] == tally.lost_frames == 1
    assert summary["nodes"] == len(frames) - 1 == MapReader(path).info().nodes
    assert summary["links"] == dict(MapReader(path).info().links)
    assert summary["loops"] == {
        "global": sum(c.type is LinkType.GLOBAL_CLOSURE for c in accepted),
        "proximity": sum(c.type is LinkType.LOCAL_SPACE_CLOSURE for c in accepted),
        "refused": len(candidates) - len(accepted),
    }
    assert sum(summary["loops"].values()) > 0
    assert summary["seed"] == 5
    assert summary["db_mb"] == pytest.approx(path.stat().st_size / 1e6, abs=1e-3)
    assert summary["ate_rmse_m"] == ate_rmse_m(slam)
    assert summary["median_ms"]["odometry"] == pytest.approx(
        np.median([update.odometry.time_ms for update in seen]), abs=0.01
    )
    nodes = [update.time_ms for update in seen if update.node is not None]
    assert summary["median_ms"]["update"] == pytest.approx(np.median(nodes), abs=0.01)
    assert 0 < summary["fps"] < 1000
    assert 50 < summary["peak_rss_mb"] == pytest.approx(peak_rss_mb(), rel=0.1)


def test_an_empty_run_has_a_summary_too() -> None:
    summary = Tally().summary(Slam(EVERY), seed=0, path=None)
    assert json.loads(json.dumps(summary)) == summary
    assert (summary["frames"], summary["nodes"], summary["fps"]) == (0, 0, 0)
    assert summary["ate_rmse_m"] is None
    assert summary["db_mb"] is None
    assert summary["median_ms"] == {"odometry": None, "update": None}
    assert summary["loops"] == {"global": 0, "proximity": 0, "refused": 0}


def test_without_ground_truth_there_is_no_error() -> None:
    slam = Slam(EVERY)
    run(Recorded([replace(frame, T_world_base=None) for frame in sparse()[:4]]), slam, lambda _: None)
    assert ate_rmse_m(slam) is None


def test_ground_truth_of_some_frames_is_enough() -> None:
    slam = Slam(EVERY)
    frames = [f if k % 2 else replace(f, T_world_base=None) for k, f in enumerate(sparse()[:12])]
    run(Recorded(frames), slam, lambda _: None)
    error = ate_rmse_m(slam)
    assert error is not None
    assert 0 < error < 0.05


def test_the_error_is_of_the_corrected_path() -> None:
    slam = mapped(0).slam
    error = ate_rmse_m(slam)
    shaken = dict(slam.graph.poses)
    try:
        for node_id in range(40, 60):
            slam.graph.poses[node_id] = slam.graph.poses[node_id].copy()
            slam.graph.poses[node_id][0, 3] += 1.0
        worse = ate_rmse_m(slam)
    finally:
        slam.graph.poses = shaken
    assert error is not None
    assert worse is not None
    assert worse > 0.2 > error
