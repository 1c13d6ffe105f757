"""What the API says of a map is what its file holds."""

from __future__ import annotations

import io
import re
import shutil
import zipfile
from pathlib import Path
from typing import Any
from urllib.parse import quote

import cv2
import numpy as np
import pytest

from slam.database import MapReader
from slam.geometry import from_quat_xyzw
from slam.maps.depth_edges import without_edges
from tests.unit.server.loop_map import ACCEPTED, NODES, REFUSED, odometry_pose, true_pose
from tests.unit.server.running import RunningApp, StartApp


def get(client: RunningApp, path: str) -> Any:
    answer = client.get(path)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_the_list_has_every_map_and_says_why_one_cannot_be_read(client: RunningApp) -> None:
    maps = {entry["id"]: entry for entry in get(client, "/api/maps")["maps"]}
    assert set(maps) == {"loops", "lab~second", "broken"}
    assert maps["lab~second"]["name"] == "lab/second"
    assert maps["loops"]["nodes"] == NODES
    assert maps["loops"]["loops"] == len(ACCEPTED)
    assert maps["loops"]["error"] is None
    assert "broken.db" in maps["broken"]["error"]


def test_a_map_that_cannot_be_read_is_refused_with_the_reason(client: RunningApp) -> None:
    answer = client.get("/api/maps/broken")
    assert answer.status_code == 422
    assert answer.json()["error"]["code"] == "database"


def test_info_counts_what_the_file_holds(client: RunningApp, maps_folder: Path) -> None:
    found = get(client, "/api/maps/loops")
    stored = MapReader(maps_folder / "loops.db").info()
    assert (found["nodes"], found["links"]) == (stored.nodes, dict(stored.links))
    assert found["refused"] == 1
    assert found["has_truth"] and found["writable"] and not found["live"]
    assert found["map_m"] == pytest.approx(found["odometry_m"], rel=0.2) and found["span_s"] > 0
    assert found["ate_m"] == pytest.approx(0.02, abs=0.02)
    assert found["parameters"] == {"Rtabmap/LoopThr": "0.2"}


def test_graph_columns_are_the_nodes_and_links(client: RunningApp) -> None:
    graph = get(client, "/api/maps/loops/graph")
    nodes, links = graph["nodes"], graph["links"]
    assert graph["full"] and nodes["id"] == list(range(1, NODES + 1))
    x, y, z, *quat = nodes["truth"][4]
    assert from_quat_xyzw(np.array(quat), np.array([x, y, z])) == pytest.approx(true_pose(5), abs=1e-5)
    x, y, z, *quat = nodes["pose"][4]
    assert from_quat_xyzw(np.array(quat), np.array([x, y, z])) == pytest.approx(odometry_pose(5), abs=1e-5)
    pairs = set(zip(links["from"], links["to"], strict=True))
    assert set(ACCEPTED) <= pairs and len(pairs) == NODES - 1 + len(ACCEPTED)
    sigma = dict(zip(zip(links["from"], links["to"], strict=True), links["residual_sigma"], strict=True))
    assert sigma[(5, 4)] == pytest.approx(0.0, abs=1e-3)
    assert sigma[ACCEPTED[0]] > 0.3


def test_tiers_are_the_last_that_the_updates_recorded(client: RunningApp) -> None:
    nodes = get(client, "/api/maps/loops/graph")["nodes"]
    tiers = dict(zip(nodes["id"], nodes["tier"], strict=True))
    assert [tiers[i] for i in (1, 6, 7, 10, 11, 12)] == ["ltm", "ltm", "wm", "wm", "stm", "stm"]


def test_node_rows_are_sorted_paged_and_searched(client: RunningApp) -> None:
    page = get(client, "/api/maps/loops/nodes?offset=2&limit=3&order=-id")
    assert page["total"] == NODES
    assert [row["id"] for row in page["nodes"]] == [10, 9, 8]
    weights = [row["weight"] for row in get(client, "/api/maps/loops/nodes?order=-weight")["nodes"]]
    assert weights == sorted(weights, reverse=True)
    assert [row["id"] for row in get(client, "/api/maps/loops/nodes?q=12")["nodes"]] == [12]


def test_a_node_in_full(client: RunningApp) -> None:
    node = get(client, "/api/maps/loops/nodes/11")
    assert node["loops"] == 1 and node["has_image"] and node["has_depth"]
    assert {(link["from"], link["to"]) for link in node["links"]} == {(11, 10), (12, 11), (11, 1)}
    apart = np.linalg.norm(np.subtract(node["truth"][:3], node["pose"][:3]))
    assert apart < 0.2, "truth is told in the frame of the map, which drift has bent a little"
    assert node["statistics"]["Timing/Total/ms"] == pytest.approx(33.25)
    assert (node["camera"]["width"], node["camera"]["height"]) == (64, 48)


@pytest.mark.parametrize("path", ["nodes/99", "nodes/99/image", "nodes/99/features", "links/2/9", "links/2/9/matches"])
def test_what_a_map_does_not_have_is_not_found(client: RunningApp, path: str) -> None:
    answer = client.get(f"/api/maps/loops/{path}")
    if path == "links/2/9/matches":
        assert answer.status_code == 200, "any two nodes can be compared"
        return
    assert answer.status_code == 404
    assert answer.json()["error"]["code"] == "not_found"


def test_whether_two_nodes_are_linked_can_be_asked_without_an_error(client: RunningApp) -> None:
    known = client.get("/api/maps/loops/links/2/3/known").json()
    assert known["link"] == client.get("/api/maps/loops/links/2/3").json() and known["note"] == ""
    assert known["link"]["scans"] == [False, False]
    for pair, why in (("2/9", "not linked"), ("2/9999", "node 9999 is not in the map")):
        answer = client.get(f"/api/maps/loops/links/{pair}/known")
        assert answer.status_code == 200 and answer.json()["link"] is None and why in answer.json()["note"]


def test_images_are_as_stored_and_previews_are_small(client: RunningApp, maps_folder: Path) -> None:
    answer = client.get("/api/maps/loops/nodes/3/image")
    assert answer.headers["content-type"] == "image/jpeg"
    assert answer.content == MapReader(maps_folder / "loops.db").image(3)
    preview = client.get("/api/maps/loops/preview.jpg").content
    shown = cv2.imdecode(np.frombuffer(preview, np.uint8), cv2.IMREAD_COLOR)
    assert shown is not None and shown.shape == (240, 320, 3)


@pytest.mark.parametrize(("path", "packed"), [("graph", "gzip"), ("nodes/3/image", None)])
def test_lists_come_packed_to_who_can_unpack_them(client: RunningApp, path: str, packed: str | None) -> None:
    able = client.get(f"/api/maps/loops/{path}", headers={"Accept-Encoding": "gzip"})
    assert able.headers.get("content-encoding") == packed
    plain = client.get(f"/api/maps/loops/{path}", headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers and plain.content == able.content


def test_depth_is_coloured_and_transparent_where_unknown(client: RunningApp, maps_folder: Path) -> None:
    data = client.get("/api/maps/loops/nodes/3/depth.png?max=5").content
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None and image.shape == (48, 64, 4)
    depth = MapReader(maps_folder / "loops.db").depth_m(3)
    assert np.array_equal(image[:, :, 3] > 0, depth > 0)
    data = client.get("/api/maps/loops/nodes/3/depth.png?max=5&edges=false").content
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert image is not None and np.array_equal(image[:, :, 3] > 0, without_edges(depth) > 0)


def test_features_have_the_depth_along_the_optical_axis(client: RunningApp, maps_folder: Path) -> None:
    found = get(client, "/api/maps/loops/nodes/3/features")
    features, words = MapReader(maps_folder / "loops.db").features(3)
    assert found["word"] == words.tolist()
    # The camera looks along x of the base.
    ahead = features.points_base[:, 0]
    for depth, x in zip(found["depth_m"], ahead, strict=True):
        assert (depth is None) == bool(np.isnan(x))
        assert depth is None or depth == pytest.approx(float(x), abs=1e-3)


def test_the_queue_has_accepted_and_refused_loops(client: RunningApp) -> None:
    queue = get(client, "/api/maps/loops/loops")
    rows = {row["key"]: row for row in queue["loops"]}
    assert rows["11-1"]["state"] == "accepted" and rows["11-1"]["reason"] is None
    assert rows["11-1"]["residual_sigma"] is not None
    refused = rows["10-3"]
    assert refused["state"] == "refused" and refused["residual_sigma"] is None
    assert refused["reason"]["test"] == "Vis/MinInliers" and refused["reason"]["value"] == 12
    assert queue["counts"]["accepted"] == 2 and queue["counts"]["refused"] == 1
    newer = get(client, "/api/maps/loops/loops?after=11")["loops"]
    assert [row["key"] for row in newer] == ["12-2"]


def test_a_link_says_why_it_is_there_with_numbers(client: RunningApp) -> None:
    link = get(client, "/api/maps/loops/links/1/11")
    assert (link["from"], link["to"], link["type"]) == (11, 1, "GlobalClosure")
    assert link["sigma_m"] == pytest.approx([0.05] * 3)
    assert link["sigma_deg"] == pytest.approx([np.degrees(4000**-0.5)] * 3)
    assert link["chi2"] > 0
    for part in ("0.42", "Rtabmap/LoopThr 0.2", "61 inliers of 90", "Vis/MinInliers 20", "RGBD/OptimizeMaxError"):
        assert part in link["explanation"]
    refused = get(client, "/api/maps/loops/links/{}/{}".format(*REFUSED))
    assert refused["state"] == "refused" and "12 inliers" in refused["explanation"]
    assert get(client, "/api/maps/loops/links/4/5")["state"] is None


def test_statistics_come_by_what_is_new(client: RunningApp) -> None:
    name = "Loop/Highest_hypothesis_value/"
    found = get(client, f"/api/maps/loops/statistics?names={name},Nothing/Like/this&after=9")
    assert found["ids"] == [10, 11, 12]
    assert found["values"][name] == pytest.approx([1.25, 1.375, 1.5])
    assert found["values"]["Nothing/Like/this"] == [None] * 3
    assert name in get(client, "/api/maps/loops/statistic-names")["names"]


def test_hypothesis_of_an_update(client: RunningApp) -> None:
    belief = get(client, "/api/maps/loops/hypothesis/6")
    assert sum(belief["posterior"]) + belief["virtual_place"] == pytest.approx(1.0, abs=1e-5)
    assert client.get("/api/maps/loops/hypothesis/1").status_code == 404


def test_parameters_of_a_closed_map_are_changed_for_its_next_session(client: RunningApp, maps_folder: Path) -> None:
    found = get(client, "/api/maps/loops/parameters")
    values = {entry["name"]: entry for entry in found["parameters"]}
    assert values["Rtabmap/LoopThr"]["value"] == 0.2 and values["Rtabmap/LoopThr"]["default"] == 0.11
    assert sum(entry["front"] for entry in found["parameters"]) == 12 and not found["live"]
    answer = client.patch("/api/maps/loops/parameters", json={"changes": {"Rtabmap/LoopThr": 0.3}})
    assert answer.status_code == 200
    found = {entry["name"]: entry["value"] for entry in get(client, "/api/maps/loops/parameters")["parameters"]}
    assert (
        found["Rtabmap/LoopThr"] == 0.3 and MapReader(maps_folder / "loops.db").parameters()["Rtabmap/LoopThr"] == "0.3"
    )
    for changes, status in (({}, 422), ({"Rtabmap/LoopThr": 3}, 422), ({"Rtabmap/Nothing": 1}, 422)):
        assert client.patch("/api/maps/loops/parameters", json={"changes": changes}).status_code == status


@pytest.mark.parametrize(
    ("format", "lines"), [("tum", NODES + 1), ("kitti", NODES), ("raw", NODES), ("g2o", NODES + NODES - 1 + 2)]
)
def test_exported_poses(client: RunningApp, format: str, lines: int) -> None:
    answer = client.get(f"/api/maps/loops/export/poses?format={format}")
    assert len(answer.text.splitlines()) == lines
    assert re.search(r'filename="loops\.((tum|kitti|raw)\.txt|g2o)"', answer.headers["content-disposition"])
    true = client.get(f"/api/maps/loops/export/poses?format={format}&which=truth")
    assert len(true.text.splitlines()) == lines and true.text != answer.text


def test_floor_plan_and_cloud_are_files_to_save(client: RunningApp, maps_folder: Path) -> None:
    shutil.copy(maps_folder / "loops.db", maps_folder / "плита.db")
    plan = client.get("/api/maps/loops/export/grid.zip")
    with zipfile.ZipFile(io.BytesIO(plan.content)) as files:
        assert sorted(files.namelist()) == ["loops.pgm", "loops.yaml"]
        assert files.read("loops.pgm").startswith(b"P5\n")
    cloud = client.get("/api/maps/плита/export/cloud.ply?voxel=0.05")
    assert cloud.content.startswith(b"ply\n")
    assert f"filename*=UTF-8''{quote('плита')}.ply" in cloud.headers["content-disposition"]
    assert client.get("/api/maps/loops/export/cloud.ply?voxel=0").status_code == 422


def test_maps_that_rtabmap_wrote_are_read_alike(shared_data: Path, start_app: StartApp) -> None:
    source = shared_data / "rtabmap_db" / "cpp_0.23.8_toyroom.db"
    if not source.is_file():
        pytest.skip("needs the databases of ../shared/data/rtabmap_db")
    client = start_app(source)
    info = get(client, "/api/maps/cpp_0.23.8_toyroom")
    assert info["version"] == "0.23.8" and info["nodes"] == 41
    loops = get(client, "/api/maps/cpp_0.23.8_toyroom/loops")["loops"]
    assert len(loops) == info["loops"] and all(row["state"] == "accepted" for row in loops)
    node = get(client, "/api/maps/cpp_0.23.8_toyroom/nodes/20")
    assert node["pose"] is not None and node["has_image"] and node["features"] > 0
    first = loops[0]
    link = get(client, f"/api/maps/cpp_0.23.8_toyroom/links/{first['from']}/{first['to']}")
    assert link["chi2"] is not None and link["explanation"]
    matched = get(client, f"/api/maps/cpp_0.23.8_toyroom/links/{first['from']}/{first['to']}/matches")
    assert sum(matched["inlier"]) > 20


def test_parameters_with_few_values_name_them(client: RunningApp) -> None:
    found = {entry["name"]: entry for entry in get(client, "/api/maps/loops/parameters")["parameters"]}
    assert {"value": 8, "label": "8 GFTT/ORB"} in found["Vis/FeatureType"]["choices"]
    assert [choice["value"] for choice in found["BRIEF/Bytes"]["choices"]] == [16, 32, 64]
    assert found["Rtabmap/LoopThr"]["choices"] == []
