"""Another threshold, foreseen: at once, without changing the map, and with the images' word on new loops."""

from __future__ import annotations

import hashlib
import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.geometry import se3_exp
from tests.tours import mapped
from tests.unit.server.running import RunningApp, StartApp


@pytest.fixture
def toured(start_app: StartApp, tmp_path: Path) -> RunningApp:
    """A server of the rendered tour's map, with its loops."""
    shutil.copy(mapped(0).path, tmp_path / "tour.db")
    return start_app(tmp_path)


def foreseen(client: RunningApp, threshold: float) -> dict[str, Any]:
    """The answer when nothing is being tried any more."""
    end = time.monotonic() + 60
    while True:
        found = client.get(f"/api/maps/tour/what-if/loops?loop_thr={threshold}&graph=true").json()
        if not found["pending"]:
            return dict(found)
        assert time.monotonic() < end
        time.sleep(0.05)


def test_the_threshold_in_force_changes_nothing_and_others_do(toured: RunningApp, tmp_path: Path) -> None:
    before = hashlib.sha256((tmp_path / "tour.db").read_bytes()).hexdigest()
    now = foreseen(toured, toured.get("/api/maps/tour/what-if/loops?loop_thr=1").json()["in_force"])
    assert now["counts"]["stays"] > 0
    assert now["counts"]["goes"] == now["counts"]["comes"] == 0
    assert now["graph"]["max_shift_m"] < 1e-3

    none = foreseen(toured, 1.0)
    assert none["counts"]["goes"] == now["counts"]["stays"]
    assert none["recall"] == 0.0
    assert none["graph"]["ate_m"] >= 0.0

    all_of_them = foreseen(toured, 0.0)
    assert all_of_them["counts"]["goes"] == all_of_them["counts"]["untried"] == 0
    tried = [one for one in all_of_them["loops"] if one["outcome"] == "refused"]
    assert tried
    assert all(one["reason"] for one in tried)
    assert all_of_them["precision"] == 1.0
    assert hashlib.sha256((tmp_path / "tour.db").read_bytes()).hexdigest() == before


def test_loops_that_would_come_and_go_are_decided_together_and_the_threshold_is_applied(
    toured: RunningApp, tmp_path: Path
) -> None:
    def decide(**body: Any) -> Any:
        return toured.post("/api/maps/tour/decisions", json=body)

    lost = [[one["from"], one["to"]] for one in foreseen(toured, 1.0)["loops"] if one["outcome"] == "goes"]
    coming = [one for one in foreseen(toured, 0.0)["loops"] if one["outcome"] == "comes"]
    gone = decide(action="reject", loops=lost).json()
    assert gone["count"] == gone["changes"]["loops_gone"] == len(lost)
    decide(action="undo")
    for one in coming[:3]:
        # Nothing in the file knows of it: what the images said goes into the map with it.
        before = len(MapReader(tmp_path / "tour.db").candidates())
        assert decide(action="approve", loops=[[one["from"], one["to"]]]).json()["changes"]["loops_new"] == 1
        kept = MapReader(tmp_path / "tour.db").candidates()
        assert len(kept) == before + 1 and kept[-1].candidate.inliers == one["inliers"]
        decide(action="undo")

    in_force = foreseen(toured, 1.0)["in_force"]
    states = {one["key"]: one["outcome"] for one in foreseen(toured, 0.05)["loops"]}
    applied = toured.patch("/api/maps/tour/parameters", json={"changes": {"Rtabmap/LoopThr": 0.05}})
    assert applied.status_code == 200 and in_force != 0.05
    now = foreseen(toured, 0.05)
    assert now["in_force"] == 0.05
    # The updates had another threshold: what they did not try is no loop that they refused.
    assert {one["key"]: one["outcome"] for one in now["loops"]} == states


def test_a_map_off_its_optimum_is_compared_with_its_optimum(toured: RunningApp, tmp_path: Path) -> None:
    thr = foreseen(toured, 1.0)["in_force"]
    ate = foreseen(toured, thr)["ate_now_m"]
    with MapWriter.open(tmp_path / "tour.db") as writer:
        poses = MapReader(tmp_path / "tour.db").poses()
        bent = {i: T @ se3_exp(np.array([0.002 * i, 0, 0, 0, 0, 0])) for i, T in poses.items()}
        writer.save_poses(bent, None)
    found = foreseen(toured, thr)
    assert found["graph"]["moved"] == 0 and found["graph"]["max_shift_m"] < 1e-3
    assert found["graph"]["stored_off_m"] > 0.05
    assert found["ate_now_m"] == pytest.approx(found["graph"]["ate_m"], abs=1e-4) == pytest.approx(ate, abs=1e-3)


def test_what_was_tried_has_evidence_and_is_foreseen_but_once(toured: RunningApp) -> None:
    tried = [
        one for one in foreseen(toured, 0.0)["loops"] if one["outcome"] == "refused" and one["inliers"] is not None
    ]
    found = toured.get(f"/api/maps/tour/links/{tried[0]['from']}/{tried[0]['to']}").json()
    assert (found["inliers"], found["reason"]["text"]) == (tried[0]["inliers"], tried[0]["reason"])
    assert toured.get("/api/maps/tour/what-if/loops?loop_thr=0&graph=true").json() == foreseen(toured, 0.0)


def test_the_3d_view_is_told_what_to_show_and_lets_go_of_it(toured: RunningApp) -> None:
    assert toured.patch("/api/scene/tour", json={"what_if": 0.5}).json()["what_if"] == 0.5
    # Each window has a view of its own.
    assert toured.patch("/api/scene/tour?viewer=a-1", json={"dark": False}).json()["what_if"] is None
    assert toured.patch("/api/scene/tour?viewer=b-2", json={"what_if": 0.3}).json()["dark"]
    assert toured.get("/api/scene/tour?viewer=a-1").json()["what_if"] is None
    assert toured.get("/api/scene/tour?viewer=b/2").status_code == 422
    assert toured.patch("/api/scene/tour", json={"dark": False}).json()["what_if"] == 0.5
    assert toured.patch("/api/scene/tour", json={"what_if": 1.5}).status_code == 422
    assert toured.patch("/api/scene/tour", json={"what_if": None}).json()["what_if"] is None


def test_a_map_without_hypotheses_has_nothing_to_foresee(client: RunningApp) -> None:
    found = client.get("/api/maps/loops/what-if/loops?loop_thr=0.5&graph=true").json()
    assert found["counts"]["comes"] == 0


def test_a_threshold_out_of_bounds_is_refused(client: RunningApp) -> None:
    assert client.get("/api/maps/loops/what-if/loops?loop_thr=1.5").status_code == 422
