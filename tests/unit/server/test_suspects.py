"""Planted false loops head the queue with the reason, and rejecting them mends the map."""

from __future__ import annotations

import shutil
import sqlite3
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slam.graph.optimizer import optimize
from slam.params import Params
from slam.types import Link, LinkType
from tests.graphs import INFORMATION, circles, write_map
from tests.unit.server.running import RunningApp, StartApp


def by_doubt(client: RunningApp, map_id: str) -> list[dict[str, Any]]:
    rows = client.get(f"/api/maps/{map_id}/loops").json()["loops"]
    return sorted(rows, key=lambda row: -row["doubt"]["score"])


def test_planted_loops_come_first_and_say_why(start_app: StartApp, tmp_path: Path) -> None:
    graph = circles(60, 12)
    false = [(5, 20), (30, 45)]
    for old, new in false:
        graph.add_link(Link(new, old, LinkType.GLOBAL_CLOSURE, np.eye(4), INFORMATION))
    graph.poses = optimize(graph, Params()).poses
    write_map(tmp_path / "planted.db", graph)
    client = start_app(tmp_path)
    rows = by_doubt(client, "planted")
    assert {(row["to"], row["from"]) for row in rows[:2]} == set(false)
    # At most the other false one agrees.
    assert rows[0]["doubt"]["agreeing"] <= 1
    found = client.get("/api/maps/planted/links/20/5").json()
    assert "Suspect: odometry alone is" in found["explanation"]
    assert "of 10 loops near by agree with it" in found["explanation"]
    assert rows[0]["graph_distance"] == 15 and rows[0]["sessions"] == [0, 0] and rows[0]["look_alike"] is None
    assert np.allclose(np.linalg.inv(found["covariance"]), INFORMATION)
    shares = [client.get("/api/maps/planted/links/{from}/{to}".format(**row)).json()["chi2_share"] for row in rows]
    assert 0.0 < sum(shares) < 1.0


def plant(path: Path, pairs: list[tuple[int, int]]) -> None:
    """Adds loops that say that two nodes are one place, as sure as the file's own, in both directions."""
    connection = sqlite3.connect(path)
    (information,) = connection.execute("SELECT information_matrix FROM Link WHERE type = 2").fetchone()
    nowhere = np.eye(4, dtype="<f4")[:3].tobytes()
    rows = [(a, b, 1, information, nowhere) for old, new in pairs for a, b in ((new, old), (old, new))]
    insert = "INSERT INTO Link (from_id, to_id, type, information_matrix, transform) VALUES (?, ?, ?, ?, ?)"
    connection.executemany(insert, rows)
    connection.commit()
    connection.close()


def reject(client: RunningApp, row: dict[str, Any]) -> dict[str, Any]:
    body = {"action": "reject", "from": row["from"], "to": row["to"]}
    answer = client.post("/api/maps/planted/decisions", json=body)
    assert answer.status_code == 200, answer.text
    return dict(answer.json()["effect"])


def test_rejecting_them_brings_the_error_of_a_real_map_back(
    start_app: StartApp, tmp_path: Path, shared_data: Path
) -> None:
    path = Path(shutil.copy(shared_data / "rtabmap_db" / "cpp_0.23.8_toyroom.db", tmp_path / "planted.db"))
    path.chmod(0o644)
    before = start_app(tmp_path).get("/api/maps/planted").json()["ate_m"]
    false = [(11, 26), (21, 36)]
    plant(path, false)
    client = start_app(tmp_path)
    rows = by_doubt(client, "planted")
    assert {(row["to"], row["from"]) for row in rows[:2]} == set(false)
    effects = [reject(client, row) for row in rows[:2]]
    assert effects[0]["ate_after_m"] > 2 * before, "one of them is still there"
    assert effects[1]["ate_after_m"] == pytest.approx(before, abs=0.001)
