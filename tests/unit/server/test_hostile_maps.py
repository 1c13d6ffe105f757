"""A map with something wrong in it: what is wrong is named, all the rest is shown, and the server goes on."""

from __future__ import annotations

import json
import random
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from server.cli.app import app
from tests.unit.database.map_records import write_map
from tests.unit.server.running import RunningApp, StartApp
from tests.unit.server.walking import Walk, walk

_PATTERN = 0xAB
_FAR = np.full(12, 1e30, "<f4").tobytes()
_HALF = np.diag([1.0, 1, 1, -1, 1, 1]).astype("<f8").tobytes()
_FAULTS = (
    ("UPDATE Node SET weight = 'heavy' WHERE id = 2", "Node", "2", "weight is 'heavy'"),
    ("UPDATE Node SET stamp = 9e999 WHERE id = 2", "Node", "2", "stamp is inf"),
    ("UPDATE Node SET map_id = 99999999999 WHERE id = 2", "Node", "2", "map_id is 99999999999"),
    (f"UPDATE Node SET pose = x'{_FAR.hex()}' WHERE id = 2", "Node", "2", "its pose is no rigid motion"),
    ("INSERT INTO Node(id, map_id) VALUES (3000000000, 0)", "Node", "3000000000", "no id of a node"),
    (
        "INSERT INTO Link SELECT 2, 1, 77, information_matrix, transform, NULL FROM Link",
        "Link",
        "2-1",
        "its type is 77",
    ),
    (f"UPDATE Link SET information_matrix = x'{_HALF.hex()}' WHERE from_id = 2", "Link", "2-1", "has -1"),
    (f"UPDATE Link SET transform = x'{_FAR.hex()}' WHERE from_id = 2 AND to_id = 1", "Link", "2-1", "no rigid motion"),
    ("UPDATE Link SET from_id = 'two' WHERE from_id = 2 AND to_id = 1", "Link", "two-1", "one of its ids is 'two'"),
    ("UPDATE Admin SET opt_poses = x'0011223344'", "Admin", "1", "matrix blob"),
    ("UPDATE deck_update SET tiers = '[[[[' WHERE id = 2", "deck_update", "2", "Expecting value"),
    ("UPDATE deck_candidate SET type = 42 WHERE id = 1", "deck_candidate", "1", "its type is 42"),
    ("UPDATE deck_session SET started = 'once'", "deck_session", "0", "started is 'once'"),
)


@pytest.fixture(scope="module")
def sound_map(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a map of three nodes."""
    return write_map(tmp_path_factory.mktemp("sound") / "map.db", 3).read_bytes()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A served folder."""
    (tmp_path / "maps").mkdir()
    return tmp_path / "maps"


@pytest.fixture
def client(start_app: StartApp, folder: Path) -> RunningApp:
    """A client of it."""
    return start_app(folder)


def changed(path: Path, whole: bytes, *statements: str, values: tuple[object, ...] = ()) -> Path:
    path.write_bytes(whole)
    with closing(sqlite3.connect(path)) as connection:
        for statement in statements:
            connection.execute(statement, values)
        connection.commit()
    return path


def test_a_row_that_makes_no_sense_is_named_and_the_rest_is_shown(
    client: RunningApp, folder: Path, sound_map: bytes
) -> None:
    for number, (statement, table, row, reason) in enumerate(_FAULTS):
        changed(folder / f"m{number}.db", sound_map, statement)
        found = client.get(f"/api/maps/m{number}").json()
        assert "faults" in found, found
        told = [fault for fault in found["faults"] if fault["table"] == table and fault["row"] == row]
        assert told and reason in told[0]["reason"], (statement, found["faults"])
        assert found["fault_count"] == len(found["faults"])
        graph = client.get(f"/api/maps/m{number}/graph").json()
        assert {1, 3} <= set(graph["nodes"]["id"]), statement
        shown = walk(client, f"m{number}")
        assert not shown.refused.keys() - _optional(number), (statement, shown.refused)


def _optional(number: int) -> set[str]:
    """What a map of these records has not, sound or not."""
    root = f"/api/maps/m{number}"
    # A file that is made of a map has all of it, or is not made.
    return {f"{root}/export/poses", *(f"{root}/hypothesis/{node_id}" for node_id in (1, 2, 3))}


@pytest.mark.parametrize(
    ("column", "value", "refused"),
    [
        ("image", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + b"\0\0\xff\xff" * 2, {"image"}),
        ("image", b"\xff\xd8 no image", {"image"}),
        ("depth", b"DEPTHRVL" + b"\xff" * 8, {"depth.png"}),
        ("depth", "text", {"depth.png"}),
        ("calibration", bytes(200), set()),
        ("calibration", 10**12, set()),
    ],
)
def test_a_node_whose_data_are_broken_shows_what_is_sound(
    client: RunningApp, folder: Path, sound_map: bytes, column: str, value: object, refused: set[str]
) -> None:
    changed(folder / "m.db", sound_map, f"UPDATE Data SET {column} = ? WHERE id = 2", values=(value,))
    node = client.get("/api/maps/m/nodes/2").json()
    assert node["features"] == 40
    assert node["pose"] is not None
    assert (node["camera"] is None) == (column == "calibration")
    assert [fault["row"] for fault in node["faults"]] == (["2"] if column == "calibration" else [])
    found = walk(client, "m")
    parts = {path.rpartition("/")[2] for path in found.refused if "/nodes/2/" in path}
    assert parts == refused
    for error in found.refused.values():
        if error["code"] == "damaged_row":
            assert (error["table"], error["row"]) == ("Data", "2")
            assert error["reason"]


def test_marks_of_html_are_text(client: RunningApp, folder: Path, sound_map: bytes) -> None:
    label = "<script>alert(1)</script>"
    changed(folder / "m.db", sound_map, "UPDATE Node SET label = ? WHERE id = 2", values=(label,))
    answer = client.get("/api/maps/m/nodes/2")
    assert answer.json()["label"] == label
    assert answer.headers["content-type"] == "application/json"
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_nothing_of_the_data_is_read_when_a_map_opens(client: RunningApp, folder: Path, sound_map: bytes) -> None:
    """All that does not fit into a row's first page is nonsense: who reads it fails, and nobody does."""
    filler = bytes([_PATTERN]) * 100_000
    path = changed(folder / "m.db", sound_map, "UPDATE Data SET image = ?, depth = image", values=(filler,))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Data SET depth = ?", (filler,))
        (size,) = connection.execute("PRAGMA page_size").fetchone()
        connection.commit()
    raw = bytearray(path.read_bytes())
    pages = [at for at in range(0, len(raw), size) if raw[at + 4 : at + size].count(_PATTERN) == size - 4]
    assert len(pages) > 100
    for at in pages:
        raw[at : at + size] = b"\xff" * size
    path.write_bytes(raw)
    for part in ("", "/graph", "/nodes", "/loops", "/decisions", "/statistic-names", "/parameters"):
        answer = client.get(f"/api/maps/m{part}")
        assert answer.status_code == 200, answer.text
    assert client.get("/api/maps").json()["maps"][0]["error"] is None
    assert len(client.get("/api/maps/m/graph").json()["nodes"]["id"]) == 3
    node = client.get("/api/maps/m/nodes/2").json()
    assert node["has_image"] and node["has_depth"] and node["features"] == 40
    assert "malformed" in node["faults"][0]["reason"]
    assert "malformed" in client.get("/api/maps/m/nodes/2/image").json()["error"]["message"]


def _damaged(whole: bytes, seed: int) -> bytes:
    chance = random.Random(seed)
    raw = bytearray(whole)
    for _ in range(chance.choice([1, 20, 300])):
        raw[chance.randrange(100, len(raw))] = chance.randrange(256)
    return bytes(raw[: chance.choice([len(raw), len(raw), chance.randrange(len(raw))])])


def _walks(client: RunningApp, folder: Path, files: Iterator[bytes]) -> list[Walk]:
    found = []
    for number, raw in enumerate(files):
        (folder / f"d{number}.db").write_bytes(raw)
        found.append(walk(client, f"d{number}", closely=True))
        (folder / f"d{number}.db").unlink()
    return found


def test_a_damaged_file_gives_answers_and_refusals_only(client: RunningApp, folder: Path, sound_map: bytes) -> None:
    found = _walks(client, folder, (_damaged(sound_map, seed) for seed in range(16)))
    assert sum(len(item.shown) > 10 for item in found) > 3
    assert sum(len(item.refused) > 3 for item in found) > 3


def test_the_command_line_names_the_row_and_tells_the_rest(tmp_path: Path, sound_map: bytes) -> None:
    path = changed(tmp_path / "m.db", sound_map, "UPDATE Link SET type = 77 WHERE from_id = 2")
    told = CliRunner().invoke(app, ["info", str(path)])
    assert told.exit_code == 0, told.output
    assert "Link, row 2-1: its type is 77" in " ".join(told.output.split())
    listed = json.loads(CliRunner().invoke(app, ["info", "--json", str(path)]).output)
    assert listed["nodes"] == 3
    assert {fault["row"] for fault in listed["faults"]} == {"2-1", "2-3"}
