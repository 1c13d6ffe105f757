"""Links by hand, nodes, labels and jobs over the API, on a served copy of a map of the rendered tour."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from slam.database import MapReader
from slam.geometry import from_quat_xyzw, inverse, transform
from tests.tours import mapped
from tests.unit.server.running import RunningApp, StartApp


@pytest.fixture
def tour(start_app: StartApp, tmp_path: Path) -> RunningApp:
    shutil.copy(mapped(0).path, tmp_path / "tour.db")
    return start_app(tmp_path)


@pytest.fixture
def reader(tour: RunningApp, tmp_path: Path) -> MapReader:
    del tour
    return MapReader(tmp_path / "tour.db")


def post(client: RunningApp, path: str, **body: Any) -> Any:
    return client.post(f"/api/maps/tour/{path}", json=body)


def loops(reader: MapReader) -> list[tuple[int, int]]:
    return [(link.from_id, link.to_id) for link in reader.links() if link.type.is_loop]


def reject_all(client: RunningApp, reader: MapReader) -> list[tuple[int, int]]:
    found = loops(reader)
    assert post(client, "decisions", action="reject", loops=[list(pair) for pair in found]).status_code == 200
    return found


def until_over(client: RunningApp) -> Any:
    """The last event of the job, as a browser hears it."""
    with client.stream_of("/api/events") as stream:
        while True:
            said = json.loads(stream.recv(timeout=60))
            if said["topic"] == "job" and said["value"]["state"] != "running":
                return said["value"]


def last_told(client: RunningApp, topic: str) -> Any:
    """The last value of a topic, which who comes later gets too."""
    with client.stream_of("/api/events") as stream:
        while True:
            said = json.loads(stream.recv(timeout=60))
            if said["topic"] == topic:
                return said["value"]


def test_a_link_is_foreseen_added_refined_edited_reset_and_all_of_it_undone(
    tour: RunningApp, reader: MapReader
) -> None:
    new, old = reject_all(tour, reader)[0]
    wanted = {"action": "add", "from": new, "to": old, "guess": "none", "author": "ann"}
    seen = post(tour, "links", **wanted, preview=True).json()
    assert seen["link"]["type"] == "UserClosure" and seen["inliers"] >= 20 and seen["reason"] is None
    assert seen["decision"]["preview"] and seen["decision"]["effect"]["moved"] > 0
    assert not loops(reader)
    done = post(tour, "links", **wanted).json()
    assert done["decision"]["revision"] is not None and loops(reader) == [(new, old)]
    assert done["link"]["transform"] == seen["link"]["transform"]
    assert post(tour, "links", **wanted).status_code == 409

    link = done["link"]
    typed = [link["transform"][0] + 0.05, *link["transform"][1:3], *link["angles_deg"]]
    edit = {"action": "edit", "from": new, "to": old, "transform": typed, "sigmas": [0.02] * 3 + [0.5] * 3}
    assert post(tour, "links", **edit).json()["link"]["transform"][0] == pytest.approx(typed[0])
    refined = post(tour, "links", action="refine", **{"from": new, "to": old}).json()
    assert refined["link"]["transform"][:3] == pytest.approx(link["transform"][:3], abs=0.01)
    reset = post(tour, "links", action="reset", **{"from": new, "to": old}).json()
    assert reset["link"]["transform"] == pytest.approx(link["transform"], abs=1e-6)
    actions = [entry["action"] for entry in tour.get("/api/maps/tour/decisions").json()["entries"]][-4:]
    assert actions == ["add", "edit", "refine", "reset"]
    for _ in actions:
        assert post(tour, "decisions", action="undo").status_code == 200
    assert not loops(reader)


def test_points_picked_in_both_images_are_judged_by_their_residuals(tour: RunningApp, reader: MapReader) -> None:
    new, old = reject_all(tour, reader)[0]
    seen = tour.get(f"/api/maps/tour/links/{new}/{old}/matches").json()
    depth = reader.depth_m(new), reader.depth_m(old)
    good = [
        {"from": [seen["x1"][k], seen["y1"][k]], "to": [seen["x2"][k], seen["y2"][k]]}
        for k in np.flatnonzero(seen["inlier"]).tolist()
        if depth[0][int(seen["y1"][k]), int(seen["x1"][k])] and depth[1][int(seen["y2"][k]), int(seen["x2"][k])]
    ][:12]
    ids = {"from": new, "to": old}
    done = post(tour, "links", action="points", pairs=good, force=True, preview=True, **ids).json()
    assert len(done["residuals_m"]) == len(good) and np.median(done["residuals_m"]) < 0.05
    false = [{"from": pair["from"], "to": good[k - 3]["to"]} for k, pair in enumerate(good)]
    refused = post(tour, "links", action="points", pairs=false, **ids)
    assert refused.status_code == 409 and "Vis/InlierDistance" in refused.json()["error"]["message"]
    assert post(tour, "links", action="points", pairs=good[:2], **ids).status_code == 422
    assert post(tour, "links", action="points", pairs=[{"from": [1], "to": [1, 2]}] * 3, **ids).status_code == 422

    # Points of both clouds, picked where the link has them.
    x, y, z, *quat_xyzw = done["link"]["transform"]
    T = from_quat_xyzw(np.array(quat_xyzw), np.array([x, y, z]))
    rows = points_of(tour, new)
    assert len(rows) > 1000 and np.isfinite(rows).all()
    picked = rows[np.linspace(0, len(rows) - 1, 6).astype(int)]
    there = transform(inverse(T), picked)
    clouds = [{"from": a.tolist(), "to": b.tolist()} for a, b in zip(picked, there, strict=True)]
    again = post(tour, "links", action="points", pairs=clouds, preview=True, **ids).json()
    assert max(again["residuals_m"]) < 1e-4
    np.testing.assert_allclose(again["link"]["transform"][:3], done["link"]["transform"][:3], atol=1e-4)


def points_of(client: RunningApp, node_id: int) -> NDArray[np.float64]:
    """The points (N, 3) that somebody picks from."""
    answer = client.get(f"/api/maps/tour/nodes/{node_id}/points")
    assert answer.headers["content-type"] == "application/octet-stream"
    return np.frombuffer(answer.content, np.dtype([("point", "<f4", 3), ("colour", "u1", 4)]))["point"].astype(
        np.float64
    )


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        ("links", {"action": "add", "from": 3, "to": 3}, 409),
        ("links", {"action": "add", "from": 3, "to": 9999}, 409),
        ("links", {"action": "refine", "from": 3, "to": 40}, 409),
        ("links", {"action": "reset", "from": 4, "to": 3}, 409),
        ("links", {"action": "edit", "from": 4, "to": 3}, 422),
        ("links", {"action": "add", "from": 20, "to": 60, "guess": "none"}, 409),
        ("nodes/drop", {"nodes": [9999]}, 409),
        ("nodes/drop", {"first": 900, "last": 999}, 404),
        ("nodes/drop", {}, 422),
        ("nodes/5/label", {"label": ""}, 409),
        ("nodes/label", {"nodes": [], "label": "a"}, 422),
        ("nodes/5/prior", {}, 409),
        ("nodes/9999/prior", {"transform": [0] * 6, "sigmas": [1] * 6}, 409),
        ("nodes/5/prior", {"transform": [0] * 6}, 422),
        ("links/covariances", {"sigmas": [0] * 6}, 409),
        ("links/covariances", {"types": ["Landmark"], "sigmas": [1] * 6}, 409),
        ("job", {}, 422),
        ("job", {"detect": {"radius_m": 0}}, 422),
        ("job/cancel", {}, 404),
    ],
)
def test_what_makes_no_sense_is_refused_and_changes_nothing(
    tour: RunningApp, reader: MapReader, path: str, body: dict[str, Any], status: int
) -> None:
    answer = post(tour, path, **body)
    assert answer.status_code == status, answer.text
    assert answer.json()["error"]["message"]
    assert not reader.journal()


def test_nodes_leave_and_come_back_and_labels_are_undone(tour: RunningApp, reader: MapReader) -> None:
    nodes = reader.info().nodes
    seen = post(tour, "nodes/drop", first=10, last=12, preview=True).json()
    assert seen["preview"] and reader.info().nodes == nodes
    assert post(tour, "nodes/drop", first=10, last=12, author="ann").status_code == 200
    graph = tour.get("/api/maps/tour/graph").json()
    assert not {10, 11, 12} & set(graph["nodes"]["id"])
    assert (13, 9) in set(zip(graph["links"]["from"], graph["links"]["to"], strict=True))
    assert post(tour, "nodes/9/label", label="door").json()["entry"]["action"] == "label"
    assert tour.get("/api/maps/tour/nodes/9").json()["label"] == "door"
    assert "door" in post(tour, "nodes/20/label", label="door").json()["error"]["message"]
    for _ in range(2):
        post(tour, "decisions", action="undo")
    assert tour.get("/api/maps/tour/nodes/9").json()["label"] == ""
    assert reader.info().nodes == nodes


def test_a_job_finds_loops_as_one_batch_which_one_undo_takes_back(tour: RunningApp, reader: MapReader) -> None:
    happened = tour.get("/api/maps/tour/timeline").json()["events"]
    reject_all(tour, reader)
    job = post(tour, "job", detect={"angle_deg": 40, "iterations": 2}, author="ann").json()
    assert job["kind"] == "detect"
    over = until_over(tour)
    assert (over["id"], over["state"], over["share"]) == (job["id"], "done", 1.0)
    assert over["decision"]["count"] == len(loops(reader)) > 1
    assert over["log"][-1].startswith(f"{over['decision']['count']} loops found")
    assert tour.get("/api/maps/tour/job").json()["job"] == over
    rows = {row["key"]: row for row in tour.get("/api/maps/tour/loops").json()["loops"]}
    assert all(rows[f"{a}-{b}"]["state"] == "added" and rows[f"{a}-{b}"]["inliers"] for a, b in loops(reader))
    assert any(row["reason"] for row in rows.values() if row["state"] == "refused")
    assert tour.get("/api/maps/tour/timeline").json()["events"] == happened, "a search is no part of the map's past"
    found = loops(reader)
    assert post(tour, "decisions", action="undo").json()["count"] == over["decision"]["count"]
    assert not loops(reader)
    for a, b in found:
        link = tour.get(f"/api/maps/tour/links/{a}/{b}").json()
        if "taken back" in link["explanation"]:
            assert link["state"] is None, "neither accepted nor refused"
    states = {row["key"]: row["state"] for row in tour.get("/api/maps/tour/loops").json()["loops"]}
    assert all(states.get(f"{a}-{b}") in (None, "rejected") for a, b in found)


def test_local_grids_are_made_anew_as_a_job_and_the_floor_plan_with_them(tour: RunningApp, reader: MapReader) -> None:
    before = tour.get("/api/maps/tour/nodes/9").json()["sensors"]["grid"]
    post(tour, "job", regrid={"changes": {"Grid/CellSize": 0.2}}, author="ann")
    over = until_over(tour)
    assert (over["kind"], over["state"], over["decision"]["entry"]["of_map"]) == ("regrid", "done", True)
    assert tour.get("/api/maps/tour/nodes/9").json()["sensors"]["grid"]["cell_size_m"] == 0.2
    end = time.monotonic() + 20
    while (plan := reader.grid()) is None and time.monotonic() < end:
        time.sleep(0.1)
    assert plan is not None and plan.cell_size == 0.2
    assert last_told(tour, "parameters") == {"Grid/CellSize": 0.2}
    values = {one["name"]: one["value"] for one in tour.get("/api/maps/tour/parameters").json()["parameters"]}
    assert values["Grid/CellSize"] == 0.2
    post(tour, "decisions", action="undo")
    assert tour.get("/api/maps/tour/nodes/9").json()["sensors"]["grid"] == before


def test_a_local_grid_is_foreseen_with_other_parameters(tour: RunningApp) -> None:
    path = "/api/maps/tour/nodes/9/grid"
    stored = tour.get("/api/maps/tour/nodes/9").json()["sensors"]["grid"]
    near, far, same = (tour.get(path, params={"changes": f'{{"Grid/RangeMax": {m}}}'}).json() for m in (0.01, 50, 5))
    assert near["obstacles"] == 0 < stored["obstacles"] == same["obstacles"] <= far["obstacles"]
    image = tour.get(f"{path}.png", params={"changes": '{"Grid/CellSize": 0.2}'})
    assert image.headers["content-type"] == "image/png" and image.content != tour.get(f"{path}.png").content
    for changes in ("[1]", '{"Kp/MaxFeatures": 9}', '{"Grid/RangeMax": -1}'):
        refused = tour.get(path, params={"changes": changes})
        assert refused.status_code in (409, 422), changes
        assert changes[2:10].strip('{"') in refused.json()["error"]["message"] or "an object" in refused.text
    assert tour.get("/api/maps/tour/nodes/999/grid").status_code == 404


def test_a_job_is_cancelled_and_nothing_else_is_done_meanwhile(tour: RunningApp, reader: MapReader) -> None:
    before = len(reader.candidates())
    post(tour, "job", detect={"radius_m": 4, "angle_deg": 180, "iterations": 100, "min_graph_distance": 2})
    busy = post(tour, "decisions", action="reject", loops=[list(loops(reader)[0])])
    assert busy.status_code == 409 and "a job is at work" in busy.json()["error"]["message"]
    assert post(tour, "job", refine={}).status_code == 409
    assert post(tour, "job/cancel").json()["job"]["state"] == "cancelled" or until_over(tour)["state"] == "cancelled"
    assert not reader.journal() and len(reader.candidates()) == before
    done = post(tour, "job", refine={"types": ["Neighbor"], "first": 5, "last": 9}, author="ann")
    assert done.status_code == 200
    assert until_over(tour)["decision"]["count"] >= 2


def test_a_prior_is_offered_ignored_switched_on_and_taken_back(tour: RunningApp, reader: MapReader) -> None:
    state = tour.get("/api/maps/tour/nodes/40/prior").json()
    assert state["ignored"] and state["transform"] is None
    higher = [*state["suggested"][:2], state["suggested"][2] + 0.5, *state["suggested"][3:]]
    wanted = {"transform": higher, "sigmas": [0.01, 0.01, 0.01, 0.5, 0.5, 0.5], "author": "ann"}
    seen = post(tour, "nodes/40/prior", **wanted, preview=True).json()
    assert "Optimizer/PriorsIgnored is on" in seen["note"] and seen["preview"] and not reader.journal()
    assert post(tour, "nodes/40/prior", **wanted).json()["effect"]["max_shift_m"] < 0.01
    on = tour.patch("/api/maps/tour/parameters", json={"changes": {"Optimizer/PriorsIgnored": False}}).json()
    assert not on["live"]
    assert not {one["name"]: one["value"] for one in on["parameters"]}["Optimizer/PriorsIgnored"]
    assert reader.parameters()["Optimizer/PriorsIgnored"] == "false"
    known = tour.get("/api/maps/tour/nodes/40/prior").json()
    assert not known["ignored"]
    assert known["transform"] == pytest.approx(higher, abs=1e-4) and known["sigmas"] == pytest.approx(wanted["sigmas"])
    done = post(tour, "nodes/40/prior", **wanted).json()
    assert done["effect"]["max_shift_m"] > 0.2 and done["note"] == "" and done["changes"]["changed"] == 1
    # Alone it moves the map as a whole.
    assert done["effect"]["ate_after_m"] == pytest.approx(done["effect"]["ate_before_m"], abs=1e-3)
    assert post(tour, "nodes/40/prior", author="bob").json()["entry"]["note"] == "removed"
    for _ in range(3):
        post(tour, "decisions", action="undo")
    assert tour.get("/api/maps/tour/nodes/40/prior").json()["transform"] is None
    assert {(e["action"], e["author"]) for e in tour.get("/api/maps/tour/decisions").json()["entries"]} >= {
        ("prior", "ann"),
        ("prior", "bob"),
    }


def test_letting_priors_count_is_part_of_the_prior_and_undone_with_it(tour: RunningApp, reader: MapReader) -> None:
    poses = reader.poses()

    def ignored() -> bool:
        seen = {one["name"]: one["value"] for one in tour.get("/api/maps/tour/parameters").json()["parameters"]}
        state = tour.get("/api/maps/tour/nodes/40/prior").json()["ignored"]
        assert state == seen["Optimizer/PriorsIgnored"] == (reader.parameters()["Optimizer/PriorsIgnored"] == "true")
        return bool(state)

    here = tour.get("/api/maps/tour/nodes/40/prior").json()["suggested"]
    wanted = {"transform": [*here[:2], here[2] + 0.5, *here[3:]], "sigmas": [0.01] * 3 + [0.5] * 3, "count": True}
    switched = "Optimizer/PriorsIgnored goes from true to false"
    seen = post(tour, "nodes/40/prior", **wanted, preview=True).json()
    assert seen["note"] == switched and seen["effect"]["max_shift_m"] > 0.2 and ignored()
    done = post(tour, "nodes/40/prior", **wanted).json()
    assert done["effect"]["max_shift_m"] == seen["effect"]["max_shift_m"] and done["note"] == switched and not ignored()
    # Once they count there is nothing to switch.
    assert post(tour, "nodes/41/prior", **wanted).json()["note"] == ""
    post(tour, "decisions", action="undo")
    assert not ignored()
    undone = post(tour, "decisions", action="undo").json()
    assert undone["note"] == "Optimizer/PriorsIgnored goes from false to true" and ignored()
    now = reader.poses()
    assert now.keys() == poses.keys() and all(np.array_equal(now[i], poses[i]) for i in poses)
    assert post(tour, "decisions", action="redo").json()["note"] == switched and not ignored()


def test_covariances_of_many_links_and_labels_of_many_nodes_are_one_undo_each(
    tour: RunningApp, reader: MapReader
) -> None:
    sigmas = [0.02, 0.02, 0.02, 0.5, 0.5, 0.0]
    wanted = {"types": ["GlobalClosure", "LocalSpaceClosure"], "sigmas": sigmas, "author": "ann"}
    seen = post(tour, "links/covariances", **wanted, preview=True).json()
    assert seen["changes"]["changed"] == seen["count"] == len(loops(reader)) and not reader.journal()
    done = post(tour, "links/covariances", **wanted).json()
    assert done["count"] == seen["count"] and done["effect"]["chi2_after"] == seen["effect"]["chi2_after"]
    changed = [link for link in reader.links() if link.type.is_loop]
    assert all(np.isclose(link.information[0, 0], 2500.0) for link in changed)
    gone = post(tour, "nodes/drop", nodes=[10, 11], preview=True).json()["changes"]
    assert gone["nodes_gone"] == 2 and gone["links_gone"] >= 3 and gone["links_new"] == 1
    assert post(tour, "nodes/label", nodes=[8, 3], label="desk").json()["count"] == 2
    assert [tour.get(f"/api/maps/tour/nodes/{i}").json()["label"] for i in (3, 8)] == ["desk 1", "desk 2"]
    for count in (2, done["count"]):
        assert post(tour, "decisions", action="undo").json()["count"] == count
    assert tour.get("/api/maps/tour/nodes/8").json()["label"] == ""
    assert not any(np.isclose(link.information[0, 0], 2500.0) for link in reader.links())
