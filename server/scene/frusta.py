"""The cameras of the nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.colours import Theme
from server.scene.lines import Lines, Segments
from server.scene.placed import PlacedGraph
from slam.camera import T_BASE_OPTICAL

if TYPE_CHECKING:
    from viser import SceneApi

#: Vertical field of view in radians, and width by height, of a camera that is only hinted at.
OPENING = (float(np.radians(48.0)), 4.0 / 3.0)
#: More frusta than this hide the map: every so manieth node shows one.
_MOST = 400
_LINE_PX = 1.0


class FrustumLayer:
    """A wire frustum for each node, or for every so manieth."""

    def __init__(self, scene: SceneApi) -> None:
        self._lines = Lines(scene, "/frusta", _LINE_PX)

    def draw(self, graph: PlacedGraph, size: float, look: Theme, *, visible: bool) -> None:
        """Show them as they are now, ``size`` metres deep."""
        every = max(1, -(-len(graph) // _MOST))
        chosen = graph.T_map[::every] if visible else graph.T_map[:0]
        self._lines.draw(wires(chosen, size), look.frustum)


def wires(T_map_base: NDArray[np.float64], size: float) -> Segments:
    """Edges (8 N, 2, 3) of the frusta of cameras that look along their base's x axis, at poses (N, 4, 4)."""
    fov, aspect = OPENING
    half = np.tan(0.5 * fov)
    corners = size * np.array([(x * aspect * half, y * half, 1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    edges = [(np.zeros(3), corner) for corner in corners]
    edges += [(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    T_map_cam = T_map_base @ T_BASE_OPTICAL
    ends = np.array(edges).reshape(-1, 3) @ np.swapaxes(T_map_cam[:, :3, :3], 1, 2) + T_map_cam[:, None, :3, 3]
    return np.asarray(ends.reshape(-1, 2, 3))
