"""One node close up: all that it saw, as points and as surfaces, its words, its scan and its local grid."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from server.browse.plan_reach import cell_count, grid_reach
from server.browse.plans import grid_pixels
from server.scene.clouds import wxyz
from server.scene.colours import Theme
from server.scene.matt import as_matt_glb
from server.scene.node_details import DetailPoints, dense_points, scan_points, word_points
from server.scene.node_surfaces import Surface, as_trimesh, node_elevation, node_mesh
from server.scene.placed import PlacedGraph
from server.schemas.scene import DepthUse, NodePart
from slam.database import MapReader
from slam.errors import SlamError
from slam.geometry import Pose, make, so3_exp
from slam.maps.local_grid import yaw

if TYPE_CHECKING:
    from viser import GlbHandle, ImageHandle, PointCloudHandle, SceneApi

T = TypeVar("T")

_LOG = logging.getLogger(__name__)
#: Above the floor, so that the map's own grid does not flicker through.
_LIFT_M = 0.03
#: viser's images have x right, y down: with the base's x up and y left.
_R_LEVEL_IMAGE = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


class CloseUpLayer:
    """What is asked for of one node is read and sent once; another node takes its place."""

    def __init__(self, scene: SceneApi) -> None:
        self._scene = scene
        self._of: tuple[int, int, Theme] | None = None
        self._depth = DepthUse()
        self._points: dict[NodePart, PointCloudHandle | None] = {}
        self._surfaces: dict[NodePart, GlbHandle | None] = {}
        self._grid: ImageHandle | None = None
        self._tried_grid = False

    def draw(
        self,
        reader: MapReader,
        revision: int,
        graph: PlacedGraph,
        node: int | None,
        parts: Collection[NodePart],
        floor_m: float,
        look: Theme,
        depth: DepthUse,
    ) -> None:
        """Show these parts of a node where it is now, of these pixels of its depth; without a node nothing."""
        known = node is not None and node in graph.rows
        of = (node, revision, look) if known and node is not None and parts else None
        if of != self._of:
            self._clear()
            self._of = of
        if of is None:
            return
        if depth != self._depth:
            self._forget_depth()
            self._depth = depth
        T_map_base = graph.T_map[graph.rows[of[0]]]
        self._draw_points(reader, of[0], T_map_base, parts, look)
        self._draw_surfaces(reader, of[0], T_map_base, parts)
        self._draw_grid(reader, of[0], T_map_base, floor_m, visible="grid" in parts)

    def _draw_points(
        self, reader: MapReader, node: int, T_map_base: Pose, parts: Collection[NodePart], look: Theme
    ) -> None:
        makers: dict[NodePart, Callable[[], DetailPoints]] = {
            "cloud": lambda: dense_points(reader, node, self._depth),
            "words": lambda: word_points(reader, node, look),
            "scan": lambda: scan_points(reader, node, look),
        }
        for part, make_points in makers.items():
            if part in parts and part not in self._points:
                self._points[part] = self._send(part, make_points)
            handle = self._points.get(part)
            if handle is not None:
                handle.wxyz, handle.position = wxyz(T_map_base), T_map_base[:3, 3]
                handle.visible = part in parts

    def _send(self, part: NodePart, make_points: Callable[[], DetailPoints]) -> PointCloudHandle | None:
        found = _made(part, make_points)
        if found is None or not len(found.points):
            return None
        return self._scene.add_point_cloud(
            f"/closeup/{part}",
            found.points,
            found.colours,
            point_size=found.size,
            point_shape="circle" if part == "words" else "rounded",
            point_shading="flat",
        )

    def _draw_surfaces(self, reader: MapReader, node: int, T_map_base: Pose, parts: Collection[NodePart]) -> None:
        makers: dict[NodePart, Callable[[], Surface]] = {
            "mesh": lambda: node_mesh(reader, node, self._depth),
            "elevation": lambda: node_elevation(reader, node, T_map_base),
        }
        for part, make_surface in makers.items():
            if part in parts and part not in self._surfaces:
                self._surfaces[part] = self._send_surface(part, make_surface)
            handle = self._surfaces.get(part)
            if handle is not None:
                turned = T_map_base if part == "mesh" else make(_levelled(T_map_base), T_map_base[:3, 3])
                handle.wxyz, handle.position = wxyz(turned), T_map_base[:3, 3]
                handle.visible = part in parts

    def _send_surface(self, part: NodePart, make_surface: Callable[[], Surface]) -> GlbHandle | None:
        found = _made(part, make_surface)
        if found is None:
            return None
        glb = as_matt_glb(as_trimesh(found))
        return self._scene.add_glb(f"/closeup/{part}", glb, cast_shadow=False, receive_shadow=False)

    def _draw_grid(self, reader: MapReader, node: int, T_map_base: Pose, floor_m: float, *, visible: bool) -> None:
        if visible and not self._tried_grid:
            self._tried_grid = True
            self._grid = self._send_grid(reader, node)
        if self._grid is None:
            return
        self._grid.wxyz = wxyz(make(_levelled(T_map_base) @ _R_LEVEL_IMAGE, np.zeros(3)))
        self._grid.position = np.array([*T_map_base[:2, 3], floor_m + _LIFT_M])
        self._grid.visible = visible

    def _send_grid(self, reader: MapReader, node: int) -> ImageHandle | None:
        grid = _made("local grid", lambda: reader.local_grid(node))
        if grid is None or not cell_count(grid):
            return None
        pixels, side = grid_pixels(grid), 2.0 * grid_reach(grid)
        image = np.ascontiguousarray(pixels[:, :, [2, 1, 0, 3]].repeat(4, axis=0).repeat(4, axis=1))
        return self._scene.add_image(
            "/closeup/grid", image, side, side, format="png", cast_shadow=False, receive_shadow=False
        )

    def _forget_depth(self) -> None:
        """What is made of depth pixels is made anew when it is asked for."""
        for handle in (self._points.pop("cloud", None), self._surfaces.pop("mesh", None)):
            if handle is not None:
                handle.remove()

    def _clear(self) -> None:
        for handle in (*self._points.values(), *self._surfaces.values(), self._grid):
            if handle is not None:
                handle.remove()
        self._points.clear()
        self._surfaces.clear()
        self._grid, self._tried_grid = None, False


def _made(part: str, make_part: Callable[[], T]) -> T | None:
    """What there is of a part; the inspector says what is missing or damaged, the other parts are shown."""
    try:
        return make_part()
    except SlamError as error:
        _LOG.info("no %s close up: %s", part, error)
        return None


def _levelled(T_map_base: Pose) -> NDArray[np.float64]:
    """Rotation (3, 3) of the levelled base frame in the map."""
    return so3_exp(np.array([0.0, 0.0, yaw(T_map_base)]))
