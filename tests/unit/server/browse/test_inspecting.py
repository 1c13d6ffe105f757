"""What the API says of pixels, scans, local grids, pairs of nodes and links is what the file holds."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from server.browse.plans import grid_pixels
from slam.database import MapReader, MapWriter
from slam.database.blobs import pack_matrix
from slam.geometry import between, inverse, rotation_angle, transform
from slam.maps.point_cloud import node_cloud
from slam.params import Params
from slam.types import LocalGrid, Scan
from tests.unit.database.map_records import CAMERA, record
from tests.unit.server.loop_map import ACCEPTED, NODES, odometry_pose, true_pose
from tests.unit.server.running import RunningApp, StartApp

Ask = Callable[[str], Any]
REACH = 1.5


@pytest.fixture(scope="module")
def odd_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three nodes: depth of half the size of the image, a scan, a grid, words that both images have."""
    path = tmp_path_factory.mktemp("odd") / "odd.db"
    with MapWriter.create(path, Params(), seed=1, source="made up") as writer:
        for node_id in (1, 2, 3):
            item = record(node_id)
            depth = np.zeros((24, 32), np.float32)
            depth[6, 10], depth[20, 31] = 2.0, 3.5
            cells = [np.array(c, np.float32).reshape(-1, 2) for c in ([(0.5, 0.0)], [(1.5, 0.25)], [(0.25, -0.5)])]
            scan = Scan(np.array([(REACH, 0.0, 0.0), (0.0, 1.0, 0.5), (-1.0, 0.0, 1.0)], np.float32))
            words = item.node.word_ids.copy()
            if node_id == 2:
                # Of the first node's words: two once, and one at two key points.
                words[:4] = (1001, 1002, 1003, 1003)
            node = replace(item.node, word_ids=words, scan=scan if node_id == 1 else None)
            grid = LocalGrid(*cells, 0.25) if node_id < 3 else None
            changes = {"node": node, "depth_m": depth if node_id < 3 else None, "grid": grid}
            writer.add_node(replace(item, **changes, update=replace(item.update, node=node)))
        writer.close_session(ram_ids=(1, 2, 3), ram_word_ids=(), params=Params())
    return path


@pytest.fixture
def odd(start_app: StartApp, odd_map: Path) -> Ask:
    client = start_app(odd_map.parent)
    return lambda path: client.get(f"/api/maps/odd/{path}").raise_for_status().json()


def test_a_pixel_has_the_depth_that_is_stored_and_the_point_of_the_cloud(odd: Ask, odd_map: Path) -> None:
    reader = MapReader(odd_map)
    points, _ = node_cloud(reader.image_bgr(1), reader.depth_m(1), reader.camera(1))
    T_map_base = reader.poses()[1]
    for column, row, depth, point in ((10, 6, 2.0, points[0]), (31, 20, 3.5, points[1])):
        found = odd(f"nodes/1/pixel?x={(column + 0.5) / 32}&y={(row + 0.5) / 24}")
        assert (found["depth_u"], found["depth_v"], found["depth_m"]) == (column, row, pytest.approx(depth))
        # A pixel of the smaller image covers two by two of the larger.
        assert (found["u"], found["v"]) == (2 * column + 0.5, 2 * row + 0.5)
        assert found["base"] == pytest.approx(point.tolist(), abs=1e-3)
        assert found["map"] == pytest.approx(transform(T_map_base, point[None])[0].tolist(), abs=1e-3)
    assert (found["depth_width"], found["depth_height"], found["stereo"]) == (32, 24, False)


def test_pixels_without_depth_say_so(odd: Ask, start_app: StartApp, odd_map: Path) -> None:
    corner = odd("nodes/1/pixel?x=1&y=1")
    assert (corner["depth_u"], corner["depth_v"]) == (31, 23)
    assert corner["depth_m"] is corner["base"] is corner["map"] is None
    client = start_app(odd_map.parent)
    missing = client.get("/api/maps/odd/nodes/3/pixel?x=0.5&y=0.5")
    assert missing.status_code == 404 and "no depth" in missing.json()["error"]["message"]
    assert client.get("/api/maps/odd/nodes/1/pixel?x=1.5&y=0").status_code == 422


def picture(client: RunningApp, path: str) -> Any:
    return cv2.imdecode(np.frombuffer(client.get(path).content, np.uint8), cv2.IMREAD_UNCHANGED)


def test_a_grid_is_seen_from_above_with_x_up_and_y_left(start_app: StartApp, odd_map: Path) -> None:
    client = start_app(odd_map.parent)
    facts = client.get("/api/maps/odd/nodes/1").json()["sensors"]["grid"]
    assert facts["reach_m"] == pytest.approx(6.5 * 0.25)
    image = picture(client, "/api/maps/odd/nodes/1/grid.png")
    assert image.shape == (13, 13, 4)
    seen = {(int(row), int(column)) for row, column in np.argwhere(image[:, :, 3] > 0)}
    # Middle is row and column 6: ground 2 cells ahead, obstacle 6 ahead and 1 left, empty 1 ahead and 2 right.
    assert seen == {(4, 6), (0, 5), (5, 8)}
    assert image[0, 5, 2] > 200, "obstacles are red"
    assert client.get("/api/maps/odd/nodes/3/grid.png").status_code == 404


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 60), st.sampled_from([0.01, 0.05, 0.1, 0.25]), st.booleans())
def test_every_cell_of_a_grid_has_a_pixel_of_its_own(half: int, size: float, between: bool) -> None:
    """Centres are whole cells from the base with some programs, half ones with others."""
    index = np.arange(-half, half) + (0.5 if between else 0.0)
    cells = (np.stack(np.meshgrid(index, index), -1).reshape(-1, 2) * size).astype(np.float32)
    none = np.zeros((0, 2), np.float32)
    image = grid_pixels(LocalGrid(cells, none, none, size))
    assert (image[..., 3] > 0).sum() == len(cells)


def test_a_scan_is_seen_from_above_and_told_of(start_app: StartApp, odd_map: Path) -> None:
    client = start_app(odd_map.parent)
    facts = client.get("/api/maps/odd/nodes/1").json()["sensors"]["scan"]
    assert (facts["points"], facts["format"], facts["intensities"]) == (3, "XYZ", False)
    assert facts["range_m"] == pytest.approx(REACH) and facts["angles_deg"] is None
    image = picture(client, "/api/maps/odd/nodes/1/scan.png")
    side, reach = len(image), facts["reach_m"]
    for x, y in ((REACH, 0.0), (0.0, 1.0), (-1.0, 0.0)):
        row, column = (int((1 - along / reach) * side / 2) for along in (x, y))
        assert image[min(row, side - 1), min(column, side - 1), 3] > 0
    assert client.get("/api/maps/odd/nodes/2/scan.png").status_code == 404


def test_two_nodes_share_the_words_that_both_have(odd: Ask) -> None:
    words = odd("nodes/1/pair/2")["words"]
    assert (words["words"], words["of"]) == (3, [10, 9])
    assert words["word"] == [1001, 1002] and words["a"] == [0, 1] and words["b"] == [0, 1]
    assert words["shared_a"] == [0, 1, 2] and words["shared_b"] == [0, 1, 2, 3], "1003 is there twice: no pair"
    back = odd("nodes/2/pair/1")["words"]
    assert (back["a"], back["b"], back["shared_a"]) == (words["b"], words["a"], words["shared_b"])


def test_two_nodes_differ_by_each_kind_of_pose(client: RunningApp) -> None:
    newer, older = ACCEPTED[0]
    pair = client.get(f"/api/maps/loops/nodes/{newer}/pair/{older}").json()
    for name, pose in (("odometry", odometry_pose), ("truth", true_pose)):
        T = between(pose(newer), pose(older))
        assert pair[name]["translation_m"] == pytest.approx(np.linalg.norm(T[:3, 3]), abs=1e-4)
        assert pair[name]["rotation_deg"] == pytest.approx(np.degrees(rotation_angle(T)), abs=1e-3)
    assert [(link["from"], link["to"], link["type"]) for link in pair["links"]] == [(newer, older, "GlobalClosure")]
    assert pair["links"][0]["sigma_m"] == pytest.approx(0.05)
    assert pair["apart_s"] == older - newer
    assert client.get("/api/maps/loops/nodes/1/pair/99").status_code == 404


def test_a_link_tells_how_far_the_graph_moved_it(client: RunningApp) -> None:
    newer, older = ACCEPTED[0]
    found = client.get(f"/api/maps/loops/links/{newer}/{older}").json()
    measured, optimized = (
        between(true_pose(newer), true_pose(older)),
        between(odometry_pose(newer), odometry_pose(older)),
    )
    off = inverse(measured) @ optimized
    assert found["off_m"] == pytest.approx(np.linalg.norm(off[:3, 3]), abs=1e-4)
    assert found["off_deg"] == pytest.approx(np.degrees(rotation_angle(off)), abs=1e-3)
    assert found["optimized"][:3] == pytest.approx(optimized[:3, 3].tolist(), abs=1e-4)
    assert found["merged_scans"] == [] and found["user_data"] is None


def test_links_are_walked_along_the_path(client: RunningApp) -> None:
    def walk(a: int, b: int) -> Any:
        return client.get(f"/api/maps/loops/links/{a}/{b}").json()["walk"]

    here, seen = [1, 2], [[1, 2]]
    while (following := walk(*here)["next"]) is not None:
        assert walk(*following)["previous"] == here
        here = following
        seen.append(here)
    assert seen == [[i, i + 1] for i in range(1, NODES)]
    assert walk(1, 2)["other"] == [1, 11] and walk(12, 11)["other"] == [2, 12]
    first, refused = walk(11, 1), walk(10, 3)
    assert (first["loops"], first["index"], first["total"], first["next"]) == (True, 1, 2, [2, 12])
    assert (refused["index"], refused["next"]) == (None, [1, 11]), "not in the graph: from where it would be"


def test_scans_that_were_merged_for_a_link_are_named(start_app: StartApp, written_map: Path, tmp_path: Path) -> None:
    path = tmp_path / "merged.db"
    shutil.copy(written_map, path)
    with sqlite3.connect(path) as connection:
        text = np.frombuffer(b"SCANS:4;5;6\0", np.int8)[None]
        connection.execute("UPDATE Link SET user_data = ? WHERE from_id = 11 AND to_id = 1", (pack_matrix(text),))
    connection.close()
    found = start_app(tmp_path).get("/api/maps/merged/links/1/11").json()
    assert found["merged_scans"] == [4, 5, 6]
    assert found["user_data"]["text"] == "SCANS:4;5;6" and found["user_data"]["bytes"] == 12
    with sqlite3.connect(path) as connection:
        connection.execute("UPDATE Link SET user_data = ? WHERE from_id = 11 AND to_id = 1", (b"nonsense" * 4,))
    connection.close()
    damaged = start_app(tmp_path).get("/api/maps/merged/links/1/11").json()
    assert damaged["user_data"] is None and "user data" in damaged["problem"] and damaged["transform"]


def test_a_node_tells_its_place_in_its_session_and_its_row(client: RunningApp) -> None:
    node = client.get("/api/maps/loops/nodes/5").json()
    assert (node["session_index"], node["session_nodes"]) == (5, NODES)
    assert node["camera"]["mount"] is not None and node["camera"]["fx"] == CAMERA.fx
    page = client.get("/api/maps/loops/nodes?order=-id&limit=1&find=5").json()
    assert page["at"] == NODES - 5
    assert client.get("/api/maps/loops/nodes?q=id:1..3&limit=1&find=5").json()["at"] is None
    wrong = client.get("/api/maps/loops/nodes?q=colour:red")
    assert wrong.status_code == 422 and wrong.json()["error"]["code"] == "query"


@pytest.mark.parametrize("colours", ["turbo", "viridis", "jet", "gray"])
def test_depth_is_coloured_between_two_distances(start_app: StartApp, odd_map: Path, colours: str) -> None:
    client = start_app(odd_map.parent)
    address = f"/api/maps/odd/nodes/1/depth.png?colours={colours}"
    near, far = (picture(client, f"{address}&min={least}&max={most}") for least, most in ((0, 2), (3.5, 5)))
    last, first = near[6, 10], far[20, 31]
    assert near[20, 31].tolist() == last.tolist(), "beyond the last distance there is one colour"
    assert far[6, 10].tolist() == first.tolist(), "and below the first"
    assert first.tolist() != last.tolist() and near[0, 0, 3] == 0
