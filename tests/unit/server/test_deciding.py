"""Decisions about the loops of a closed map, through a process of its own."""

from __future__ import annotations

import sqlite3
import time
from pathlib import Path
from typing import Any

import pytest

from slam.database import MapReader, MapWriter
from tests.unit.server.running import RunningApp, StartApp


def decide(client: RunningApp, action: str, ids: tuple[int, int] | None = None, map_id: str = "loops") -> Any:
    body = {"action": action} if ids is None else {"action": action, "from": ids[0], "to": ids[1]}
    return client.post(f"/api/maps/{map_id}/decisions", json=body)


def states(client: RunningApp) -> dict[str, str]:
    return {row["key"]: row["state"] for row in client.get("/api/maps/loops/loops").json()["loops"]}


def explanation(client: RunningApp, pair: tuple[int, int]) -> str:
    return str(client.get("/api/maps/loops/links/{}/{}".format(*pair)).json()["explanation"])


def test_reject_undo_redo_approve_and_what_the_page_sees_of_it(client: RunningApp, maps_folder: Path) -> None:
    before = client.get("/api/maps/loops/graph").json()
    done = decide(client, "reject", (1, 11)).json()
    assert done["entry"]["action"] == "reject" and done["effect"]["moved"] > 0
    assert done["effect"]["chi2_after"] < done["effect"]["chi2_before"]
    assert done["effect"]["ate_after_m"] is not None
    assert done["revision"] == before["revision"] + 1, "one change, for which the map is read anew once"
    assert states(client)["11-1"] == "rejected"
    assert "Rejected" in explanation(client, (11, 1)) and "engine had accepted it" in explanation(client, (11, 1))
    after = client.get(f"/api/maps/loops/graph?after={before['revision']}").json()
    assert after["full"], "a link is gone"
    assert (11, 1) not in set(zip(after["links"]["from"], after["links"]["to"], strict=True))

    assert decide(client, "undo").json()["entry"]["action"] == "undo"
    assert states(client)["11-1"] == "accepted"
    assert explanation(client, (11, 1)).startswith("Accepted")
    assert decide(client, "redo").status_code == 200
    assert states(client)["11-1"] == "rejected"
    assert decide(client, "approve", (10, 3)).json()["entry"]["action"] == "add"
    assert states(client)["10-3"] == "added"
    again = decide(client, "approve", (10, 3))
    assert again.status_code == 409 and again.json()["error"]["code"] == "decision"

    journal = client.get("/api/maps/loops/decisions").json()["entries"]
    assert [entry["action"] for entry in journal] == ["reject", "undo", "redo", "add"]
    node = client.get("/api/maps/loops/nodes/10").json()
    assert [entry["action"] for entry in node["decisions"]] == ["add"]
    assert "Added by hand" in explanation(client, (10, 3))
    assert len(MapReader(maps_folder / "loops.db").journal()) == 4


def test_several_are_foreseen_decided_and_undone_together(client: RunningApp, maps_folder: Path) -> None:
    path = maps_folder / "loops.db"
    links = MapReader(path).info().links
    body = {"action": "reject", "loops": [[11, 1], [12, 2], [4, 5]], "author": " ann "}
    said = client.post("/api/maps/loops/decisions", json={**body, "preview": True}).json()
    assert said["preview"] and said["revision"] is None and said["count"] == 2
    assert [(one["from"], one["to"]) for one in said["refused"]] == [(4, 5)]
    assert not MapReader(path).journal() and MapReader(path).info().links == links

    done = client.post("/api/maps/loops/decisions", json=body).json()
    assert done["effect"] == said["effect"] and done["effect"]["separated"] == 0
    journal = client.get("/api/maps/loops/decisions").json()["entries"]
    assert [(entry["batch"], entry["author"]) for entry in journal] == [(1, "ann")] * 2
    assert journal[0]["effect"]["ate_after_m"] == done["effect"]["ate_after_m"] is not None
    assert decide(client, "undo").json()["count"] == 2
    assert MapReader(path).info().links == links
    assert decide(client, "redo").json()["count"] == 2
    assert [states(client)[key] for key in ("11-1", "12-2")] == ["rejected"] * 2


def test_a_new_link_comes_as_an_increment(client: RunningApp) -> None:
    before = client.get("/api/maps/loops/graph").json()
    revision = decide(client, "approve", (10, 3)).json()["revision"]
    after = client.get(f"/api/maps/loops/graph?after={before['revision']}").json()
    assert not after["full"] and after["revision"] >= revision
    assert (10, 3) in set(zip(after["links"]["from"], after["links"]["to"], strict=True))
    nothing = client.get(f"/api/maps/loops/graph?after={after['revision']}").json()
    assert not nothing["full"] or nothing["revision"] > after["revision"]


def test_the_stream_tells_of_decisions(client: RunningApp) -> None:
    with client.stream_of("/api/events") as stream:
        decide(client, "reject", (12, 2))
        # The editor tells of the new graph as well, before or after.
        heard = [stream.recv(timeout=20)]
        while not all(any(f'"topic":"{topic}"' in text for text in heard) for topic in ("decision", "graph")):
            heard.append(stream.recv(timeout=20))
    assert any('"topic":"decision"' in text and '"reject"' in text for text in heard)


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"action": "approve"}, 422),
        ({"action": "reject", "from": 11}, 422),
        ({"action": "reject", "from": 11, "to": 1, "loops": [[12, 2]]}, 422),
        ({"action": "reject", "loops": [[4, 5], [5, 6]]}, 409),
        ({"action": "burn", "from": 1, "to": 2}, 422),
        ({"action": "reject", "from": 4, "to": 5}, 409),
        ({"action": "approve", "from": 2, "to": 9}, 409),
        ({"action": "undo"}, 409),
        ({"action": "redo"}, 409),
    ],
)
def test_what_cannot_be_decided_is_refused_and_changes_nothing(
    client: RunningApp, maps_folder: Path, body: dict[str, Any], status: int
) -> None:
    links = MapReader(maps_folder / "loops.db").info().links
    answer = client.post("/api/maps/loops/decisions", json=body)
    assert answer.status_code == status
    assert answer.json()["error"]["message"]
    assert MapReader(maps_folder / "loops.db").info().links == links


def test_a_map_that_somebody_writes_is_busy_and_still_browsable(client: RunningApp, maps_folder: Path) -> None:
    with MapWriter.open(maps_folder / "loops.db"):
        answer = decide(client, "reject", (11, 1))
        assert answer.status_code == 409 and answer.json()["error"]["code"] == "map_busy"
        assert client.get("/api/maps/loops/graph").status_code == 200
    assert decide(client, "reject", (11, 1)).status_code == 200


def test_after_the_server_the_file_is_plain_and_holds_the_decision(
    start_app: StartApp, maps_folder: Path, written_map: Path
) -> None:
    client = start_app(maps_folder)
    decide(client, "reject", (11, 1))
    client.__exit__()
    assert sorted(path.name for path in maps_folder.glob("loops.db*")) == ["loops.db"]
    with sqlite3.connect(maps_folder / "loops.db") as connection:
        assert connection.execute("pragma integrity_check").fetchone() == ("ok",)
    assert MapReader(maps_folder / "loops.db").journal()[0].action == "reject"
    assert not MapReader(written_map).journal()


def test_the_grid_is_made_anew_after_a_decision(client: RunningApp, maps_folder: Path) -> None:
    reader = MapReader(maps_folder / "loops.db")
    decide(client, "reject", (11, 1))
    end = time.monotonic() + 20
    while reader.grid() is None and time.monotonic() < end:
        time.sleep(0.1)
    assert reader.grid() is not None
