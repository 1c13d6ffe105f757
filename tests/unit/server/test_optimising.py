"""The graph otherwise: optimised on trial, in pieces, and its nodes by numbers."""

from __future__ import annotations

import hashlib
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.scene.colours import DARK, node_colours
from slam.database import MapReader
from tests.tours import mapped
from tests.unit.server.loop_map import ACCEPTED, NODES, REFUSED
from tests.unit.server.running import RunningApp, StartApp
from tests.unit.server.scene.placing import long_walk


@pytest.fixture
def toured(start_app: StartApp, tmp_path: Path) -> RunningApp:
    """A server of the rendered tour's map, with its loops."""
    shutil.copy(mapped(0).path, tmp_path / "tour.db")
    return start_app(tmp_path)


def optimised(client: RunningApp, **ask: Any) -> dict[str, Any]:
    answer = client.post("/api/maps/tour/what-if/optimise", json=ask)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_an_optimisation_on_trial_tells_each_iteration_and_changes_nothing(toured: RunningApp, tmp_path: Path) -> None:
    before = hashlib.sha256((tmp_path / "tour.db").read_bytes()).hexdigest()
    found = optimised(toured, start="odometry")
    costs = [step["chi2"] for step in found["steps"]]
    assert len(costs) > 1
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == pytest.approx(found["now"]["chi2"], rel=1e-3), "the map is at its minimum already"
    assert found["max_shift_m"] < 1e-3
    assert found["dropped"] == 0
    for solver in range(3):
        assert optimised(toured, solver=solver)["steps"][-1]["chi2"] == pytest.approx(costs[-1], rel=1e-3)
    assert len(optimised(toured, kernel="GNC", start="map")["steps"]) == 2
    assert hashlib.sha256((tmp_path / "tour.db").read_bytes()).hexdigest() == before


def test_classes_that_do_not_count_are_left_out(toured: RunningApp) -> None:
    whole = optimised(toured)
    loops = ["GlobalClosure", "LocalSpaceClosure"]
    without = optimised(toured, without=loops)
    assert without["links"] < whole["links"]
    assert without["steps"][-1]["chi2"] < whole["steps"][-1]["chi2"]
    assert without["max_shift_m"] > 1e-3
    assert without["steps"][-1]["ate_m"] > whole["steps"][-1]["ate_m"]
    apart = optimised(toured, without=["Neighbor"], start="map")
    assert apart["nodes"] + apart["dropped"] == whole["nodes"]
    assert apart["dropped"] > 0
    assert optimised(toured, root=5)["root"] == 5
    assert toured.post("/api/maps/tour/what-if/optimise", json={"root": 9999}).status_code == 404


def test_poses_of_an_optimisation_are_foreseen_kept_and_taken_back(toured: RunningApp, tmp_path: Path) -> None:
    reader = MapReader(tmp_path / "tour.db")
    before, ask = reader.poses(), {"without": ["GlobalClosure", "LocalSpaceClosure"], "root": 3}
    tried = optimised(toured, **ask)

    def keep(**more: Any) -> Any:
        return toured.post("/api/maps/tour/poses/optimise", json={"ask": ask, "author": "ann", **more})

    seen = keep(preview=True).json()
    assert seen["preview"] and "A later decision" in seen["note"] and not reader.journal()
    done = keep().json()
    assert done["effect"] == seen["effect"] and done["entry"]["action"] == "optimise"
    assert done["effect"]["max_shift_m"] == pytest.approx(tried["max_shift_m"], rel=1e-3)
    assert done["effect"]["ate_after_m"] == pytest.approx(tried["steps"][-1]["ate_m"], rel=1e-3)
    assert optimised(toured, **ask, start="map")["max_shift_m"] < 1e-3, "the map is there now"
    assert keep(step=5000).status_code == 409
    assert keep(ask={"without": ["Nearby"]}).status_code == 404
    turned = toured.post("/api/maps/tour/poses/turn", json={"to": "truth"}).json()
    assert turned["effect"]["moved"] > 0 and "ground truth" in turned["entry"]["note"]
    assert toured.post("/api/maps/tour/poses/turn", json={"yaw_deg": 0}).status_code == 422
    for _ in range(2):
        assert toured.post("/api/maps/tour/decisions", json={"action": "undo"}).status_code == 200
    after = reader.poses()
    assert all(np.array_equal(before[i], after[i]) for i in before)


def test_a_graph_in_one_piece_is_told_as_one(client: RunningApp) -> None:
    found = client.get("/api/maps/loops/components").json()
    assert found["count"] == 1
    assert (found["components"][0]["nodes"], found["components"][0]["newest"]) == (NODES, NODES)


def test_a_piece_tells_what_was_refused_between_it_and_the_rest(client: RunningApp, maps_folder: Path) -> None:
    with closing(sqlite3.connect(maps_folder / "loops.db")) as connection, connection:
        for a, b in ((6, 5), *ACCEPTED):
            connection.execute("DELETE FROM Link WHERE from_id IN (?, ?) AND to_id IN (?, ?)", (a, b, a, b))
    found = client.get("/api/maps/loops/components").json()
    assert [(one["id"], one["nodes"]) for one in found["components"]] == [(6, NODES - 5), (1, 5)]
    misses = {(one["from"], one["to"]): one for one in found["components"][1]["near_misses"]}
    assert {pair for pair, one in misses.items() if one["removed"]} == set(ACCEPTED)
    miss = misses[REFUSED]
    assert miss["component"] == 6
    assert (miss["reason"]["value"], miss["reason"]["threshold"]) == (12.0, 20.0)


def test_numbers_of_nodes_have_names_and_a_scale(client: RunningApp) -> None:
    names = client.get("/api/maps/loops/node-values").json()["names"]
    assert names[:2] == ["loops", "residual"]
    assert "stat:Timing/Total/ms" in names
    loops = client.get("/api/maps/loops/node-values/loops").json()
    assert (loops["known"], loops["low"], loops["high"]) == (NODES, 0.0, 1.0)
    timing = client.get("/api/maps/loops/node-values/stat:Timing/Total/ms").json()
    assert timing["known"] == NODES
    assert client.get("/api/maps/loops/node-values/stat:nonsense").status_code == 404


def test_nodes_without_a_number_are_grey() -> None:
    graph = long_walk(6)
    values = {int(i): float(i) for i in graph.ids[:4]}
    colours = node_colours(graph, "loops", DARK, values)
    assert [tuple(rgb) for rgb in colours[4:].tolist()] == [DARK.refused, DARK.refused]
    assert len(np.unique(colours[:4], axis=0)) == 4
