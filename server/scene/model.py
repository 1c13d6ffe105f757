"""The mesh or cloud that was assembled of the whole map and stored with it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from server.scene.cloud_points import spread_points
from server.scene.matt import as_matt_glb
from slam.database import MapReader
from slam.database.images import decode_color
from slam.database.mesh_rows import Cloud, Mesh
from slam.errors import DatabaseError

if TYPE_CHECKING:
    import trimesh
    from viser import GlbHandle, PointCloudHandle, SceneApi

_LOG = logging.getLogger(__name__)
_GRAY = 170
#: Points of a cloud that are sent, and pixels of a texture along its longer side.
_MOST_POINTS, _MOST_PIXELS = 400_000, 8192


class ModelLayer:
    """What is stored is read and sent when it is first asked for, and anew when the file has another."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._handle: GlbHandle | PointCloudHandle | None = None
        self._revision = -1

    def draw(self, reader: MapReader, revision: int, *, visible: bool) -> None:
        """Show the model of a map at a revision of its file."""
        if visible and revision != self._revision:
            self._revision = revision
            if self._handle is not None:
                self._handle.remove()
            self._handle = self._send(reader)
        if self._handle is not None:
            self._handle.visible = visible

    def _send(self, reader: MapReader) -> GlbHandle | PointCloudHandle | None:
        try:
            mesh, cloud = reader.mesh(), reader.cloud()
            if mesh is not None:
                return self._scene.add_glb("/model", as_matt_glb(as_trimesh(mesh)))
        except DatabaseError as error:
            _LOG.warning("no model: %s", error)
            return None
        return None if cloud is None else self._send_cloud(cloud)

    def _send_cloud(self, cloud: Cloud) -> PointCloudHandle:
        finite = np.flatnonzero(np.isfinite(cloud.points).all(axis=1))
        kept, side = spread_points(cloud.points[finite], _MOST_POINTS)
        rows = finite[kept]
        return self._scene.add_point_cloud("/model", cloud.points[rows], _colours(cloud)[rows], point_size=side)


def as_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    """The mesh with its texture, or with the colours of its points.

    Raises:
        DatabaseError: the texture is no image.
    """
    import trimesh

    triangles = np.concatenate([np.zeros((0, 3), np.int32), *(part.triangles for part in mesh.parts)])
    if mesh.textures is None or any(part.corners is None for part in mesh.parts):
        return trimesh.Trimesh(mesh.cloud.points, triangles, vertex_colors=_colours(mesh.cloud), process=False)
    # Textures lie side by side, and a point may have another place in each: every triangle has its own corners.
    count = len(mesh.parts)
    places = [
        (part.corners.reshape(-1, 2) + np.array([at, 0.0])) / np.array([count, 1.0])
        for at, part in enumerate(mesh.parts)
        if part.corners is not None
    ]
    visual = cast("Any", trimesh.visual.TextureVisuals)(uv=np.concatenate(places), image=_texture(mesh.textures))
    corners = np.arange(triangles.size).reshape(-1, 3)
    return trimesh.Trimesh(mesh.cloud.points[triangles.ravel()], corners, visual=visual, process=False)


def _texture(blob: bytes) -> object:
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(decode_color(blob)[..., ::-1]))
    image.thumbnail((_MOST_PIXELS, _MOST_PIXELS))
    return image


def _colours(cloud: Cloud) -> NDArray[np.uint8]:
    return np.full(cloud.points.shape, _GRAY, np.uint8) if cloud.colours is None else cloud.colours
