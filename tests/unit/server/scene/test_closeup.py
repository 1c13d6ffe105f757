"""One node close up: what it saw is where it stood, and is sent once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from server.browse.snapshot import Snapshot
from server.scene.closeup import CloseUpLayer
from server.scene.colours import DARK, LIGHT
from server.scene.framing import beside
from server.scene.node_details import dense_points, scan_points
from server.scene.placed import PlacedGraph
from server.schemas.scene import DepthUse
from slam.database.scans import StoredScan
from slam.maps.views import node_views
from slam.types import LocalGrid, Scan
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import CAMERA, HALF, true_pose

NODE = 5
GRID = LocalGrid(
    np.zeros((0, 2), np.float32), np.array([[2.0, 1.0]], np.float32), np.zeros((0, 2), np.float32), cell_size=0.5
)


def draw(
    layer: CloseUpLayer,
    snapshot: Snapshot,
    node: int | None,
    parts: list[Any],
    look: Any = DARK,
    depth: DepthUse | None = None,
) -> None:
    layer.draw(snapshot.reader, 1, PlacedGraph.of(snapshot), node, parts, -1.0, look, depth or DepthUse())


def test_every_pixel_of_the_node_is_a_point_of_the_room(snapshot: Snapshot) -> None:
    found = dense_points(snapshot.reader, NODE, DepthUse())
    assert len(found.points) == CAMERA.width * CAMERA.height
    T = true_pose(NODE)
    placed = found.points @ T[:3, :3].T + T[:3, 3]
    assert np.abs(placed[:, :2]).max() < HALF + 0.02


def test_parts_are_sent_once_and_leave_with_the_node(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer = CloseUpLayer(viewer.scene)
    draw(layer, snapshot, NODE, ["cloud"])
    cloud = viewer.scene.get_handle_by_name("/closeup/cloud")
    np.testing.assert_allclose(cloud.position, true_pose(NODE)[:3, 3], atol=1e-6)
    sent.take()
    draw(layer, snapshot, NODE, [])
    assert viewer.scene.get_handle_by_name("/closeup/cloud") is None
    draw(layer, snapshot, NODE, ["cloud", "scan"])
    sent.take()
    draw(layer, snapshot, NODE, ["scan"])
    assert not viewer.scene.get_handle_by_name("/closeup/cloud").visible
    draw(layer, snapshot, NODE, ["cloud", "scan"])
    assert not any("PointCloud" in kind for kind, _ in sent.take()), "the node has no scan, and its cloud is there"
    draw(layer, snapshot, NODE, ["cloud"], LIGHT)
    assert any("PointCloud" in kind for kind, _ in sent.take())
    draw(layer, snapshot, None, ["cloud"])
    draw(layer, snapshot, 9999, ["cloud"])
    assert viewer.scene.get_handle_by_name("/closeup/cloud") is None


def test_cloud_and_mesh_are_made_of_the_pixels_that_are_asked_for(
    viewer: Any, snapshot: Snapshot, sent: Sent, monkeypatch: Any
) -> None:
    (view,) = node_views(snapshot.reader, NODE)
    depth_m = view.depth_m.copy()
    depth_m[:, : depth_m.shape[1] // 2] *= 0.5
    monkeypatch.setattr("server.scene.node_details.node_views", lambda *_: [replace(view, depth_m=depth_m)])

    def points(**use: Any) -> Any:
        return dense_points(snapshot.reader, NODE, DepthUse(**use)).points

    height, width = depth_m.shape
    assert len(points(every=4)) == -(-height // 4) * -(-width // 4)
    assert len(points(edges=False)) == height * (width - 2), "on both sides of the step"
    far_m = float(np.median(depth_m))
    assert len(points(far_m=far_m)) == (depth_m <= far_m).sum()

    layer = CloseUpLayer(viewer.scene)
    draw(layer, snapshot, NODE, ["cloud", "mesh", "words"])
    sent.take()
    draw(layer, snapshot, NODE, ["cloud", "mesh", "words"], depth=DepthUse(every=2))
    again = [kind for kind, _ in sent.take()]
    assert sum("PointCloud" in kind for kind in again) == 1 and sum("Glb" in kind for kind in again) == 1
    draw(layer, snapshot, NODE, ["cloud", "mesh", "words"], depth=DepthUse(every=2))
    assert not any("PointCloud" in kind or "Glb" in kind for kind, _ in sent.take())


def test_surfaces_are_sent_once_and_stand_where_the_node_does(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer, T = CloseUpLayer(viewer.scene), true_pose(NODE)
    draw(layer, snapshot, NODE, ["mesh", "elevation"])
    mesh, heights = (viewer.scene.get_handle_by_name(f"/closeup/{part}") for part in ("mesh", "elevation"))
    np.testing.assert_allclose(mesh.position, T[:3, 3], atol=1e-6)
    np.testing.assert_allclose(heights.position, T[:3, 3], atol=1e-6)
    assert heights.wxyz[1:3] == pytest.approx([0.0, 0.0]), "it is turned about the vertical alone"
    sent.take()
    draw(layer, snapshot, NODE, ["mesh"])
    draw(layer, snapshot, NODE, ["mesh", "elevation"])
    assert heights.visible and not any("Glb" in kind for kind, _ in sent.take())
    draw(layer, snapshot, None, ["mesh"])
    assert viewer.scene.get_handle_by_name("/closeup/mesh") is None


def test_a_local_grid_lies_as_its_cells_do(viewer: Any, snapshot: Snapshot, monkeypatch: Any) -> None:
    monkeypatch.setattr(type(snapshot.reader), "local_grid", lambda *_: GRID)
    layer = CloseUpLayer(viewer.scene)
    draw(layer, snapshot, NODE, ["grid"])
    image = viewer.scene.get_handle_by_name("/closeup/grid")
    w, x, y, z = image.wxyz
    turned = (
        2.0 * np.array([x * x + w * w - 0.5, x * y + w * z, x * z - w * y]),
        2.0 * np.array([x * y - w * z, y * y + w * w - 0.5, y * z + w * x]),
    )
    # The obstacle's pixel, 4 cells ahead and 2 left of the middle one, in metres along the image's own axes.
    at = image.position - 1.0 * turned[0] - 2.0 * turned[1]
    T = true_pose(NODE)
    np.testing.assert_allclose(at[:2], (T[:3, :3] @ (2.0, 1.0, 0.0) + T[:3, 3])[:2], atol=1e-6)
    assert -1.0 < at[2] < -0.9


def test_scans_show_what_is_stored_of_their_points(snapshot: Snapshot, monkeypatch: Any) -> None:
    points = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], np.float32)
    normals = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], np.float32)

    def colours(**stored: Any) -> list[list[int]]:
        scan = Scan(points, stored.pop("normals", None))
        values = {"intensities": None, "colours": None, **stored}
        made = StoredScan(
            scan, format="", range_m=(0, 0), angles_rad=(0, 0, 0), most=0, T_base_scan=np.eye(4), **values
        )
        monkeypatch.setattr(type(snapshot.reader), "stored_scan", lambda *_: made)
        found: list[list[int]] = scan_points(snapshot.reader, NODE, DARK).colours.tolist()
        return found

    assert colours() == [list(DARK.overlay_from)] * 2
    assert colours(normals=normals) == [[128, 128, 255], [255, 128, 128]]
    dim, bright = colours(intensities=np.array([0.0, 9.0], np.float32), normals=normals)
    assert dim[2] > dim[0] or dim != bright
    assert colours(colours=np.array([[1, 2, 3], [4, 5, 6]], np.uint8)) == [[1, 2, 3], [4, 5, 6]]


def test_the_camera_comes_from_behind_the_node_and_above() -> None:
    T = true_pose(NODE)
    found = beside(T)
    toward = found.look_at - found.position
    assert toward[:2] @ T[:2, 0] > 0 and toward[2] < 0
    assert (found.position - T[:3, 3])[:2] @ T[:2, 0] < 0
