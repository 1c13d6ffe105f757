"""Another threshold, foreseen: at once, without changing the map, and with the images' word on new loops."""

from __future__ import annotations

import hashlib
import shutil
import time
from pathlib import Path
from typing import Any

import pytest

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


def test_what_was_tried_has_evidence_and_is_foreseen_but_once(toured: RunningApp) -> None:
    tried = [
        one for one in foreseen(toured, 0.0)["loops"] if one["outcome"] == "refused" and one["inliers"] is not None
    ]
    found = toured.get(f"/api/maps/tour/links/{tried[0]['from']}/{tried[0]['to']}").json()
    assert (found["inliers"], found["reason"]["text"]) == (tried[0]["inliers"], tried[0]["reason"])
    assert toured.get("/api/maps/tour/what-if/loops?loop_thr=0&graph=true").json() == foreseen(toured, 0.0)


def test_the_3d_view_is_told_what_to_show_and_lets_go_of_it(toured: RunningApp) -> None:
    assert toured.patch("/api/scene/tour", json={"what_if": 0.5}).json()["what_if"] == 0.5
    assert toured.patch("/api/scene/tour", json={"dark": False}).json()["what_if"] == 0.5
    assert toured.patch("/api/scene/tour", json={"what_if": 1.5}).status_code == 422
    assert toured.patch("/api/scene/tour", json={"what_if": None}).json()["what_if"] is None


def test_a_map_without_hypotheses_has_nothing_to_foresee(client: RunningApp) -> None:
    found = client.get("/api/maps/loops/what-if/loops?loop_thr=0.5&graph=true").json()
    assert found["counts"]["comes"] == 0


def test_a_threshold_out_of_bounds_is_refused(client: RunningApp) -> None:
    assert client.get("/api/maps/loops/what-if/loops?loop_thr=1.5").status_code == 422
