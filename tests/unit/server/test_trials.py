"""Trials over the API: started, followed, compared, taken over, kept, cancelled and discarded."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copyfile
from typing import Any

import pytest

from slam.database import MapReader
from tests.tours import saved
from tests.unit.server.running import RunningApp, StartApp

URL = "/api/maps/tour/trials"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "maps"
    made.mkdir()
    copyfile(saved(0), made / "tour.db")
    return made


def carried_out(client: RunningApp, changes: dict[str, Any]) -> dict[str, Any]:
    """A trial that has ended, as the stream tells."""
    with client.stream_of("/api/events") as stream:
        answer = client.post(URL, json={"changes": changes})
        assert answer.status_code == 200, answer.text
        assert client.post(URL, json={"changes": changes}).status_code == 409
        while True:
            told = json.loads(stream.recv(timeout=120))
            if told["topic"] == "trial" and told["value"]["state"] != "running":
                assert told["map"] == "tour"
                return dict(told["value"])


def test_a_trial_is_compared_taken_over_kept_and_discarded(start_app: StartApp, folder: Path) -> None:
    client = start_app(folder)
    assert client.get(URL).json() == {"trials": []}
    trial = carried_out(client, {"Mem/STMSize": 4, "Vis/MinInliers": 30})
    assert trial["state"] == "done" and trial["number"] == 1 and trial["share"] == 1
    assert {"name": "Mem/STMSize", "before": 10, "value": 4} in trial["changes"]
    assert start_app(folder).get(URL).json()["trials"] == [trial], "another server finds it"

    found = client.get(f"{URL}/1").json()["comparison"]
    assert found["baseline"]["stm_max"] == 10 and found["tried"]["stm_max"] == 4
    assert found["tried"]["nodes"] == found["original"]["nodes"] == len(found["tried"]["poses"])
    assert len(found["tried"]["wm"]) == len(found["tried"]["update_ids"])

    assert client.patch("/api/scene/tour", json={"trial": 1}).json()["trial"] == 1
    taken = client.post(f"{URL}/1/take-over").json()
    assert taken["applied"] == ["Mem/STMSize", "Vis/MinInliers"] and taken["left"] == []
    assert MapReader(folder / "tour.db").parameters()["Vis/MinInliers"] == "30"
    assert client.get(URL).json()["trials"][0]["stale"]

    assert client.post(f"{URL}/1/keep", json={"name": "better"}).json() == {"map": "better"}
    assert client.get("/api/maps/better").json()["nodes"] == found["tried"]["nodes"]
    assert MapReader(folder / "better.db").image(1) == MapReader(folder / "tour.db").image(1)
    for name, status in (("better", 422), ("../out", 422), ("tour", 422)):
        assert client.post(f"{URL}/1/keep", json={"name": name}).status_code == status
    assert client.post(f"{URL}/1/discard").json() == {"trials": []}
    assert client.get(f"{URL}/1").status_code == 404 and client.post(f"{URL}/1/discard").status_code == 404
    assert not list((client.services.settings.scratch).iterdir())


@pytest.mark.parametrize(
    "changes", [{}, {"Rtabmap/Nothing": 1}, {"Rtabmap/LoopThr": 7}, {"Odom/Strategy": 1}, {"Mem/STMSize": 10}]
)
def test_what_cannot_be_tried_is_refused_and_leaves_nothing(
    start_app: StartApp, folder: Path, changes: dict[str, Any]
) -> None:
    client = start_app(folder)
    answer = client.post(URL, json={"changes": changes})
    assert answer.status_code == 422 and answer.json()["error"]["message"]
    assert client.get(URL).json() == {"trials": []} and not client.services.settings.scratch.exists()


def test_a_cancelled_trial_leaves_nothing_and_one_that_fails_says_why(start_app: StartApp, folder: Path) -> None:
    client = start_app(folder)
    assert client.post(URL, json={"changes": {"Mem/STMSize": 4}}).status_code == 200
    assert client.post(f"{URL}/1/discard").status_code == 409
    assert client.post(f"{URL}/1/cancel").json() == {"trials": []}
    assert client.post(f"{URL}/1/cancel").status_code == 404
    home = next(client.services.settings.scratch.iterdir())
    assert not list(home.glob("*/*"))
    copyfile(saved(0), folder / "tour.db")
    with (folder / "tour.db").open("r+b") as file:
        file.seek(file.seek(0, 2) // 2)
        file.write(b"nonsense" * 4096)
    trial = carried_out(client, {"Mem/STMSize": 4})
    assert trial["state"] == "failed" and "tour.db" in trial["text"]
    assert client.get(f"{URL}/1").json()["comparison"] is None
    assert client.post(f"{URL}/1/keep", json={"name": "bad"}).status_code == 409
