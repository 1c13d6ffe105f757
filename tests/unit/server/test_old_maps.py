"""Maps of old versions, of killed programs and of rich sensors, as the page gets them."""

from __future__ import annotations

import hashlib
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from tests.unit.database import old_files as old
from tests.unit.server.running import RunningApp, StartApp

INFORMATION = np.eye(6).tobytes()


def get(client: RunningApp, path: str) -> Any:
    """The JSON of an answer that must be a good one."""
    answer = client.get(path)
    assert answer.status_code == 200, answer.text
    return answer.json()


def execute(path: Path, *statements: tuple[str, tuple[object, ...]]) -> None:
    """Change a file by plain SQLite."""
    with closing(sqlite3.connect(path)) as connection:
        for statement, values in statements:
            connection.execute(statement, values)
        connection.commit()


@pytest.fixture
def client(tmp_path: Path, start_app: StartApp) -> RunningApp:
    """Serves an old map, one of a killed program, and one of a stereo camera with markers."""
    folder = tmp_path / "maps"
    folder.mkdir()
    old.write_old(folder / "old.db", (0, 11, 13))
    execute(
        old.write_old(folder / "killed.db", (0, 20, 0)),
        ("UPDATE Info SET last_sign_added = 0, STM_size = 0, parameters = ''", ()),
        ("UPDATE Admin SET opt_ids = NULL, opt_poses = NULL", ()),
        ("DELETE FROM Link WHERE from_id < to_id", ()),
        ("UPDATE Node SET weight = -9 WHERE id = 1", ()),
        ("UPDATE Node SET gps = x'00112233445566' WHERE id = 2", ()),
    )
    stereo = old.calibration_of((0, 17, 6), stereo=True)
    right = old.png(old.IMAGE[:, ::-1].copy())
    execute(
        old.write_old(folder / "rich.db", (0, 17, 6), calibration=stereo, depth=right),
        (
            "INSERT INTO Link VALUES (1, -7, 8, ?, ?, ?)",
            (INFORMATION, old.pose(2).tobytes(), old.z(np.float32([[0.25]]), 5)),
        ),
        ("INSERT INTO Link VALUES (1, 1, 9, ?, ?, NULL)", (INFORMATION, old.pose(1).tobytes())),
    )
    return start_app(folder)


def test_an_old_map_is_shown_with_what_is_made_up_for(client: RunningApp) -> None:
    info = get(client, "/api/maps/old")
    assert info["version"] == "0.11.13"
    assert not info["writable"]
    assert info["notes"] == [
        "No optimised poses are stored: they are computed from the links, and not written.",
        "Files of RTAB-Map before 0.18 can be looked at, but not changed.",
    ]
    graph = get(client, "/api/maps/old/graph")
    assert [pose[0] for pose in graph["nodes"]["pose"]] == pytest.approx([0.0, 0.5, 1.0])
    assert get(client, "/api/maps/old/statistic-names")["names"] == ["Loop/Id/", "Timing/Total/ms"]
    values = {entry["name"]: entry["value"] for entry in get(client, "/api/maps/old/parameters")["parameters"]}
    assert (values["Kp/MaxFeatures"], values["Rtabmap/LoopThr"]) == (400, 0.15)
    body = {"action": "reject", "from": 3, "to": 1}
    assert "0.18 or later" in client.post("/api/maps/old/decisions", json=body).text


def test_a_killed_map_says_what_is_missing(client: RunningApp) -> None:
    info = get(client, "/api/maps/killed")
    assert not info["clean"]
    assert [note.partition(":")[0] for note in info["notes"]] == [
        "The last session was not closed in order",
        "Links between neighbours that are stored in one direction only, and used all the same",
        "It does not say with what parameters it was made",
        "No optimised poses are stored",
    ]
    assert get(client, "/api/maps/killed/nodes")["total"] == 2
    with_dropped = get(client, "/api/maps/killed/nodes?dropped=true")
    assert [(row["id"], row["weight"]) for row in with_dropped["nodes"]] == [(1, -9), (2, 0), (3, 2)]
    dropped = get(client, "/api/maps/killed/nodes/1")
    assert dropped["weight"] == -9
    assert dropped["pose"] is None
    assert client.get("/api/maps/killed/nodes/1/image").status_code == 200


def test_a_damaged_sensor_does_not_hide_the_node(client: RunningApp) -> None:
    node = get(client, "/api/maps/killed/nodes/2")
    assert node["has_image"]
    (problem,) = node["sensors"]["problems"]
    assert "node 2" in problem
    assert "48 bytes each" in problem


def test_sensors_of_a_node(client: RunningApp) -> None:
    sensors = get(client, "/api/maps/rich/nodes/1")["sensors"]
    assert sensors["gps"]["latitude"] == 45.5
    assert sensors["velocity"] == [1, 2, 3, 4, 5, 6]
    assert sensors["user_data"] == {"rows": 1, "columns": 7, "type": "int8", "bytes": 7, "text": "kitchen"}
    assert (sensors["scan"]["points"], sensors["grid"]["ground"], sensors["problems"]) == (10, 2, [])


def test_a_stereo_camera_shows_its_right_image(client: RunningApp) -> None:
    node = get(client, "/api/maps/rich/nodes/1")
    assert (node["has_image"], node["has_depth"], node["has_right"]) == (True, False, True)
    assert [camera["baseline_m"] for camera in node["cameras"]] == [old.BASELINE]
    assert client.get("/api/maps/rich/nodes/1/right").headers["content-type"] == "image/png"
    assert client.get("/api/maps/old/nodes/1/right").status_code == 404
    for made in ("disparity.png?colours=gray", "depth.png?max=9"):
        assert client.get(f"/api/maps/rich/nodes/1/{made}").headers["content-type"] == "image/png"
    refused = client.get("/api/maps/old/nodes/1/disparity.png")
    assert refused.status_code == 404 and "no stereo pair" in refused.json()["error"]["message"]


def test_how_sure_the_camera_was_of_its_depth_is_shown(start_app: StartApp, tmp_path: Path) -> None:
    old.write_old(tmp_path / "sure.db", (0, 22, 0))
    damaged = old.write_old(tmp_path / "damaged.db", (0, 22, 0))
    execute(damaged, ("UPDATE Data SET depth_confidence = x'0102030405060708090a0b0c0d0e0f1011'", ()))
    old.write_old(tmp_path / "before.db", (0, 20, 0))
    client = start_app(tmp_path)
    assert get(client, "/api/maps/sure/nodes/1")["has_confidence"]
    image = cv2.imdecode(
        np.frombuffer(client.get("/api/maps/sure/nodes/1/confidence.png?colours=gray").content, np.uint8), -1
    )
    assert image is not None and image.shape == (48, 64, 4) and (image[..., 0] == 255).all()
    assert get(client, "/api/maps/sure/nodes/1/pixel?x=0.5&y=0.5")["confidence"] == 100
    assert get(client, "/api/maps/damaged/nodes/1/pixel?x=0.5&y=0.5")["confidence"] is None
    assert client.get("/api/maps/damaged/nodes/1/confidence.png").json()["error"]["table"] == "Data"
    assert not get(client, "/api/maps/before/nodes/1")["has_confidence"]
    refused = client.get("/api/maps/before/nodes/1/confidence.png")
    assert refused.status_code == 404 and "no confidence" in refused.json()["error"]["message"]


def test_landmarks_and_links_of_one_node(client: RunningApp) -> None:
    (landmark,) = get(client, "/api/maps/rich/landmarks")["landmarks"]
    assert (landmark["id"], landmark["length_m"], landmark["seen_from"]) == (7, 0.25, [1])
    assert landmark["pose"][:3] == [0.5, 0.0, 0.0]
    links = get(client, "/api/maps/rich/nodes/1")["links"]
    assert [(link["type"], link["from"], link["to"]) for link in links] == [
        ("Neighbor", 2, 1),
        ("GlobalClosure", 3, 1),
        ("Landmark", 1, -7),
        ("Gravity", 1, 1),
    ]


def test_sessions_say_what_they_are_one_map_with(client: RunningApp) -> None:
    (session,) = get(client, "/api/maps/old")["session_list"]
    assert (session["map_id"], session["nodes"], session["joined_with"]) == (0, 3, [])


def test_looking_changes_no_byte(client: RunningApp, tmp_path: Path) -> None:
    files = sorted((tmp_path / "maps").iterdir())
    before = [hashlib.sha256(path.read_bytes()).hexdigest() for path in files]
    for name in ("old", "killed", "rich"):
        for path in ("", "/graph", "/nodes/2", "/nodes/2/features", "/loops", "/landmarks", "/preview.jpg"):
            get_any = client.get(f"/api/maps/{name}{path}")
            assert get_any.status_code == 200, get_any.text
    assert sorted((tmp_path / "maps").iterdir()) == files
    assert [hashlib.sha256(path.read_bytes()).hexdigest() for path in files] == before


def test_a_real_file_of_a_killed_program(shared_data: Path, start_app: StartApp) -> None:
    (path,) = (shared_data / "rtabmap_db").glob("Strroke21*.db")
    client = start_app(path)
    name = f"/api/maps/{path.stem}"
    info = get(client, name)
    assert [note[:8] for note in info["notes"]] == ["The last", "Links be", "No optim"]
    nodes = get(client, f"{name}/graph")["nodes"]
    assert len(nodes["id"]) == 50
    assert None not in nodes["pose"]
