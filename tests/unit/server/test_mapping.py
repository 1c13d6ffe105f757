"""A run, steered through the API."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from slam.database import MapReader
from tests.tours import saved
from tests.unit.server.running import RunningApp, StartApp

#: The engine compiles itself when it first runs on a machine, which a busy one takes long for.
pytestmark = pytest.mark.timeout(600)

IGNORED = "Optimizer/PriorsIgnored"
TOUR = "tour:fps=5,width=320,height=240,frames=120"


@pytest.fixture
def app(start_app: StartApp, tmp_path: Path) -> RunningApp:
    folder = tmp_path / "maps"
    folder.mkdir()
    return start_app(folder, sources=(tmp_path,))


@pytest.fixture
def run(app: RunningApp) -> Iterator[RunningApp]:
    """A run of which at least three nodes are in the file."""
    answer = app.post("/api/session", json={"source": TOUR, "map": "flat", "speed": 2})
    assert answer.status_code == 200, answer.text
    wait_for(app, lambda state: state["nodes"] >= 3)
    yield app


def wait_for(app: RunningApp, holds: Callable[[dict[str, Any]], bool], seconds: float = 240) -> dict[str, Any]:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        state: dict[str, Any] = app.get("/api/session").json()
        if holds(state):
            return state
        time.sleep(0.05)
    raise AssertionError(f"not within {seconds} s: {state}")


def engine_pid(app: RunningApp) -> int:
    pid = app.services.session.pid
    assert pid is not None
    return pid


def test_a_run_from_start_to_stop(run: RunningApp, tmp_path: Path) -> None:
    assert run.get("/api/session").json()["map"] == "flat"
    info = run.get("/api/maps/flat").json()
    assert info["live"] and info["nodes"] >= 3
    paused = run.post("/api/session/pause").json()
    assert paused["state"] == "paused"
    frame = run.get("/api/session").json()["frame"]
    time.sleep(0.5)
    assert run.get("/api/session").json()["frame"] == frame
    run.post("/api/session/step")
    assert wait_for(run, lambda state: state["frame"] == frame + 1)["state"] == "paused"
    run.post("/api/session/resume")
    wait_for(run, lambda state: state["frame"] > frame + 1)
    stopped = run.post("/api/session/stop").json()
    assert stopped["state"] == "stopped"
    assert sorted(path.name for path in (tmp_path / "maps").iterdir()) == ["flat.db"]
    stored = MapReader(tmp_path / "maps" / "flat.db").info()
    assert stored.clean and stored.nodes == stopped["nodes"]
    assert len(stored.sources) == 1 and stored.sources[0].startswith("tour:fps=5")
    assert run.post("/api/session/pause").status_code == 409


def test_parameters_change_while_it_runs_and_are_echoed(run: RunningApp, tmp_path: Path) -> None:
    with run.stream_of("/api/events") as stream:
        answer = run.patch("/api/maps/flat/parameters", json={"changes": {"Rtabmap/LoopThr": 0.5}})
        values = {entry["name"]: entry["value"] for entry in answer.json()["parameters"]}
        assert answer.json()["live"] and values["Rtabmap/LoopThr"] == 0.5
        heard = {}
        while "parameters" not in heard:
            message = json.loads(stream.recv(timeout=20))
            heard[message["topic"]] = message["value"]
        assert heard["parameters"] == {"Rtabmap/LoopThr": 0.5}
    for changes in ({"Rtabmap/LoopThr": 2}, {"Rtabmap/LoopTr": 0.1}, {}, {"Grid/CellSize": 0.1}):
        refused = run.patch("/api/maps/flat/parameters", json={"changes": changes})
        assert refused.status_code == 422 and refused.json()["error"]["code"] == "parameter"
    still = run.get("/api/maps/flat/parameters").json()
    assert {entry["name"]: entry["value"] for entry in still["parameters"]}["Rtabmap/LoopThr"] == 0.5
    changed = MapReader(tmp_path / "maps" / "flat.db").parameter_changes()
    assert [(change.name, change.value) for change in changed] == [("Rtabmap/LoopThr", "0.5")]


def test_links_labels_and_priors_are_edited_while_the_map_is_made_and_nodes_stay(
    run: RunningApp, tmp_path: Path
) -> None:
    def post(path: str, **body: Any) -> Any:
        return run.post(f"/api/maps/flat/{path}", json=body)

    run.post("/api/session/pause")
    nodes = run.get("/api/session").json()["nodes"]
    seen = run.get("/api/maps/flat/nodes/3/prior").json()["suggested"]
    first = run.get("/api/maps/flat/nodes/1/prior").json()["suggested"]
    apart = [a - b for a, b in zip(first, seen, strict=True)]
    typed = {"action": "edit", "from": 3, "to": 1, "transform": apart, "sigmas": [0.5] * 3 + [20] * 3, "force": True}
    assert post("nodes/2/label", label="door").status_code == 200
    linked = post("links", **typed).json()
    assert linked["decision"]["effect"]["chi2_after"] > linked["decision"]["effect"]["chi2_before"]
    prior = {"transform": seen, "sigmas": [0.1] * 3 + [1] * 3}
    assert post("nodes/3/prior", **prior).json()["note"].startswith("Optimizer/")
    assert post("nodes/3/prior", **prior, count=True).json()["note"] == f"{IGNORED} goes from true to false"
    assert not run.get("/api/maps/flat/nodes/3/prior").json()["ignored"]
    assert post("decisions", action="undo").json()["note"] == f"{IGNORED} goes from false to true"
    assert run.get("/api/maps/flat/nodes/3/prior").json()["ignored"]
    assert post("links/covariances", types=["Neighbor"], sigmas=[0.1] * 6).json()["count"] == nodes - 1
    placements = post("poses/optimise", ask={"start": "map"}, preview=True), post("poses/turn", yaw_deg=5)
    for refused in (post("nodes/drop", nodes=[2]), post("job", detect={}), *placements):
        assert refused.status_code == 409 and "top the run first" in refused.json()["error"]["message"]
    assert post("decisions", action="undo").json()["count"] == nodes - 1
    run.post("/api/session/resume")
    wait_for(run, lambda state: state["nodes"] > nodes + 1)
    assert run.post("/api/session/stop").json()["state"] == "stopped"
    reader = MapReader(tmp_path / "maps" / "flat.db")
    assert reader.info().clean and reader.node(2).label == "door"
    assert {(3, 1, "UserClosure"), (3, 3, "PosePrior")} <= {(k.from_id, k.to_id, k.type.label) for k in reader.links()}
    # It goes on as a map that nobody makes, with the decisions of the run.
    assert [post("decisions", action="undo").json()["entry"]["action"] for _ in range(3)] == ["undo"] * 3
    assert not reader.node(2).label
    changed = [(one.name, one.value) for one in reader.parameter_changes()]
    assert changed == [(IGNORED, "false"), (IGNORED, "true")] and reader.parameters()[IGNORED] == "true"


def test_the_stream_brings_the_last_values_first_and_then_each_node(run: RunningApp) -> None:
    with run.stream_of("/api/events") as stream:
        seen: dict[str, Any] = {}
        end = time.monotonic() + 30
        while not {"session", "update", "graph"} <= seen.keys() and time.monotonic() < end:
            message = json.loads(stream.recv(timeout=20))
            seen[message["topic"]] = message["value"]
    assert seen["session"]["state"] == "running"
    assert seen["update"]["id"] >= 3 and "Timing/Total/ms" in seen["update"]["statistics"]


def test_one_run_at_a_time_and_no_map_is_overwritten(run: RunningApp) -> None:
    other = run.post("/api/session", json={"source": TOUR, "map": "other"})
    assert other.status_code == 409 and other.json()["error"]["code"] == "engine"
    run.post("/api/session/stop")
    same = run.post("/api/session", json={"source": TOUR, "map": "flat"})
    assert same.status_code == 422 and "exists" in same.json()["error"]["message"]


def test_a_killed_engine_leaves_a_sound_map_and_a_server_that_starts_another(run: RunningApp, tmp_path: Path) -> None:
    os.kill(engine_pid(run), signal.SIGKILL)
    state = wait_for(run, lambda state: state["state"] == "failed", 20)
    assert "SIGKILL" in state["message"]
    info = run.get("/api/maps/flat").json()
    assert info["nodes"] >= state["nodes"] and not info["live"] and not info["clean"]
    assert run.get("/api/maps/flat/nodes/3").status_code == 200
    assert run.get("/api/maps/flat/nodes/3/image").status_code == 200
    again = run.post("/api/session", json={"source": TOUR, "map": "again"})
    assert again.status_code == 200, again.text
    assert run.post("/api/session/stop").json()["state"] == "stopped"
    assert MapReader(tmp_path / "maps" / "flat.db").info().nodes >= 3


@pytest.mark.parametrize(
    ("run_it", "code"),
    [
        ({"source": "tour:laps=x", "map": "m"}, "source"),
        ({"source": "/etc", "map": "m"}, "source"),
        ({"source": ".", "map": "m"}, "source"),
        ({"source": TOUR, "map": "../m"}, "invalid_request"),
        ({"source": TOUR, "map": "m", "params": {"Rtabmap/LoopThr": 7}}, "parameter"),
        ({"source": TOUR, "map": "m", "params": {"Nothing/Here": 7}}, "parameter"),
    ],
)
def test_a_run_that_cannot_be_is_refused_with_the_reason(
    app: RunningApp, tmp_path: Path, run_it: dict[str, Any], code: str
) -> None:
    answer = app.post("/api/session", json=run_it)
    assert answer.status_code == 422, answer.text
    assert answer.json()["error"]["code"] == code
    assert list((tmp_path / "maps").glob("*.db")) == []


def test_decisions_while_mapping_go_to_the_engine_itself(run: RunningApp) -> None:
    answer = run.post("/api/maps/flat/decisions", json={"action": "undo"})
    assert answer.status_code == 409 and answer.json()["error"]["code"] == "decision"
    assert run.get("/api/session").json()["state"] == "running"


def test_a_map_that_is_there_gets_a_session_and_is_localised_in(app: RunningApp, tmp_path: Path) -> None:
    shutil.copy(saved(0), tmp_path / "maps" / "room.db")
    # Somebody has just decided something: the process that holds the map for decisions must let go of it.
    app.post("/api/maps/room/decisions", json={"action": "undo"})
    source = "tour:width=320,height=240,fps=2,frames=6"
    begun = app.post("/api/session", json={"source": source, "map": "room", "mode": "append"})
    assert begun.status_code == 200, begun.text
    assert wait_for(app, lambda state: state["state"] == "finished")["map"] == "room"
    info = MapReader(tmp_path / "maps" / "room.db").info()
    assert len(info.sources) == 2
    app.post("/api/session", json={"source": source, "map": "room", "mode": "localize"})
    wait_for(app, lambda state: state["state"] == "finished")
    after = MapReader(tmp_path / "maps" / "room.db").info()
    assert after.nodes == info.nodes
    missing = app.post("/api/session", json={"source": source, "map": "none", "mode": "append"})
    assert missing.status_code == 404
