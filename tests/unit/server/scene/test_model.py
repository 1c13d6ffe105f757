"""The stored mesh or cloud is sent when it is asked for, with its texture or the colours of its points."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from server.scene.matt import as_matt_glb
from server.scene.model import ModelLayer, as_trimesh
from slam.database import MapReader
from slam.database.mesh_rows import Cloud, Mesh, Part
from tests.unit.database import old_files as old

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
TRIANGLES = np.array([[0, 1, 2]], np.int32)
CORNERS = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]], np.float32)


def test_textures_side_by_side_are_found() -> None:
    image = np.zeros((8, 16, 3), np.uint8)
    image[:, 8:] = (0, 0, 255)
    texture = cv2.imencode(".png", image)[1].tobytes()
    made = as_trimesh(Mesh(Cloud(POINTS, None), (Part(TRIANGLES, CORNERS), Part(TRIANGLES + 1, CORNERS)), texture))
    assert made.vertices.tolist() == POINTS[[0, 1, 2, 1, 2, 3]].tolist()
    np.testing.assert_allclose(made.visual.uv[:, 0], [0, 0.5, 0.5, 0.5, 1, 1])
    assert made.visual.material.image.getpixel((12, 4)) == (255, 0, 0)


def test_without_a_texture_points_have_colours() -> None:
    colours = np.arange(12, dtype=np.uint8).reshape(4, 3)
    made = as_trimesh(Mesh(Cloud(POINTS, colours), (Part(TRIANGLES, None),), None))
    assert made.visual.vertex_colors[:, :3].tolist() == colours.tolist()


@pytest.mark.parametrize("textured", [True, False])
def test_what_is_sent_is_no_metal_and_has_two_sides(textured: bool) -> None:
    image = cv2.imencode(".png", np.full((8, 8, 3), 200, np.uint8))[1].tobytes()
    part = Part(TRIANGLES, CORNERS if textured else None)
    glb = as_matt_glb(as_trimesh(Mesh(Cloud(POINTS, None), (part,), image if textured else None)))
    tree = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    (material,) = tree["materials"]
    look = material["pbrMetallicRoughness"]
    assert look["metallicFactor"] == 0.0 and ("baseColorTexture" in look) == textured and material["doubleSided"]
    assert "baseColorFactor" not in look, "colours are not darkened"
    assert [part["material"] for mesh in tree["meshes"] for part in mesh["primitives"]] == [0]


def test_it_is_read_when_it_is_asked_for(viewer: Any, tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 17, 6))
    layer, reader = ModelLayer(viewer.scene), MapReader(path)
    layer.draw(reader, 1, visible=False)
    assert layer._handle is None
    layer.draw(reader, 1, visible=True)
    mesh = layer._handle
    assert mesh is not None
    layer.draw(reader, 1, visible=False)
    assert layer._handle is mesh
    assert not mesh.visible
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Admin SET opt_polygons = NULL")
        connection.commit()
    layer.draw(reader, 2, visible=True)
    assert layer._handle is not mesh
    assert type(layer._handle).__name__ == "PointCloudHandle"


def test_a_damaged_model_is_none(viewer: Any, tmp_path: Path) -> None:
    path = old.write_old(tmp_path / "old.db", (0, 17, 6))
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE Admin SET opt_polygons_size = 2")
        connection.commit()
    layer = ModelLayer(viewer.scene)
    layer.draw(MapReader(path), 1, visible=True)
    assert layer._handle is None
