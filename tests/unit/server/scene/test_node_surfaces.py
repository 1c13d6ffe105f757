"""Meshes and heights of one node: where corners are, what is joined, and in which colours."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from server.browse.snapshot import Snapshot
from server.scene.node_details import dense_points
from server.scene.node_surfaces import Surface, as_trimesh, elevation, node_elevation, node_mesh
from server.schemas.scene import DepthUse
from slam.errors import DatabaseError
from slam.geometry import make, so3_exp
from slam.maps.views import View
from tests.unit.server.scene.room_map import CAMERA, HALF, true_pose

NODE = 5


def colours(surface: Surface) -> NDArray[np.uint8]:
    """Of each corner, red first, as the picture has it there."""
    height, width = surface.picture.shape[:2]
    columns = np.floor(surface.places[:, 0] * width).astype(int)
    rows = np.floor((1.0 - surface.places[:, 1]) * height).astype(int)
    return np.asarray(surface.picture[rows, columns, ::-1])


def test_a_mesh_has_the_points_of_the_cloud_in_their_colours(snapshot: Snapshot) -> None:
    mesh, cloud = node_mesh(snapshot.reader, NODE, DepthUse()), dense_points(snapshot.reader, NODE, DepthUse())
    np.testing.assert_allclose(mesh.corners, cloud.points)
    np.testing.assert_array_equal(colours(mesh), cloud.colours)
    most = 2 * (CAMERA.width - 1) * (CAMERA.height - 1)
    assert 0.8 * most < len(mesh.triangles) <= most
    T = true_pose(NODE)
    # Triangles lie on the walls, and none cuts a corner of the room.
    middles = mesh.corners[mesh.triangles].mean(axis=1) @ T[:3, :3].T + T[:3, 3]
    assert np.abs(middles[:, :2]).max() < HALF + 0.02


def test_what_is_behind_is_not_joined_with_the_front(snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    depth_m = np.where(np.arange(CAMERA.width) < CAMERA.width // 2, 1.0, 3.0)
    depth_m = np.tile(depth_m.astype(np.float32), (CAMERA.height, 1))
    depth_m[:2] = 0.0
    image = np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8)
    views = (View(image, depth_m, CAMERA), View(image, depth_m, CAMERA))
    monkeypatch.setattr("server.scene.node_surfaces.node_views", lambda *_: views)
    mesh = node_mesh(snapshot.reader, NODE, DepthUse())
    assert len(mesh.corners) == 2 * CAMERA.width * (CAMERA.height - 2)
    assert mesh.picture.shape[1] == 2 * CAMERA.width
    depth = np.linalg.inv(CAMERA.T_base_cam)[2] @ np.column_stack([mesh.corners, np.ones(len(mesh.corners))]).T
    assert np.ptp(depth[mesh.triangles], axis=1).max() < 1e-5
    assert len(mesh.triangles) == 4 * (CAMERA.width - 2) * (CAMERA.height - 3)
    assert (mesh.places[len(mesh.places) // 2 :, 0] > 0.5).all()


def test_tiles_are_at_the_highest_point_and_walls_join_them() -> None:
    points = np.array([[0.1, 0.1, 0.2], [0.15, 0.1, 1.0], [0.3, 0.1, 0.4], [2.1, 0.1, 0.4]])
    found = elevation(points, 0.25)
    assert len(found.corners) == 4 * (3 + 1) and len(found.triangles) == 2 * (3 + 1)
    tiles, wall = found.corners[:12].reshape(3, 4, 3), found.corners[12:]
    np.testing.assert_allclose(tiles[:, :, 2], np.repeat([[1.0], [0.4], [0.4]], 4, axis=1), atol=1e-6)
    np.testing.assert_allclose(tiles[:, :, :2].min(axis=1), [[0, 0], [0.25, 0], [2.0, 0]], atol=1e-6)
    np.testing.assert_allclose(wall[:, 0], 0.25)
    np.testing.assert_allclose(wall[:, 2], [1.0, 1.0, 0.4, 0.4])
    red, blue = colours(found)[0].astype(int), colours(found)[4].astype(int)
    assert red[0] > red[2] and blue[2] > blue[0]
    sent = as_trimesh(found)
    assert len(sent.faces) == len(found.triangles)


def test_heights_are_level_however_the_base_is_held(snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    T = true_pose(NODE)
    upright = node_elevation(snapshot.reader, NODE, T)
    tilt = make(so3_exp(np.array([0.2, -0.3, 0.0])), np.zeros(3))
    seen = dense_points(snapshot.reader, NODE, DepthUse()).points @ tilt[:3, :3]
    monkeypatch.setattr("server.scene.node_surfaces._points", lambda *_: seen.astype(np.float64))
    held = node_elevation(snapshot.reader, NODE, T @ tilt)
    assert held.corners[:, 2].min() == pytest.approx(upright.corners[:, 2].min(), abs=0.02)
    assert held.corners[:, 2].max() == pytest.approx(upright.corners[:, 2].max(), abs=0.02)


def test_a_node_that_saw_nothing_says_so(snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("server.scene.node_surfaces._points", lambda *_: np.zeros((0, 3)))
    with pytest.raises(DatabaseError, match="node 5 saw nothing"):
        node_elevation(snapshot.reader, NODE, np.eye(4))
