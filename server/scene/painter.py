"""Draws a map with all its layers into a viser server; one thread at a time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from server.browse.snapshot import Pair, Snapshot
from server.scene.clouds import CloudLayer
from server.scene.colours import Theme, theme
from server.scene.floor import FloorLayer, floor_height
from server.scene.framing import FIELD_OF_VIEW, Framing, frame
from server.scene.frusta import FrustumLayer
from server.scene.highlight import Highlight
from server.scene.links import LinkLayer
from server.scene.measure import Measure
from server.scene.newest import NewestLayer
from server.scene.nodes import NodeLayer
from server.scene.paths import PathLayer
from server.scene.placed import PlacedGraph
from server.scene.viewer import Viewer
from server.schemas.scene import Scene
from slam.geometry import Pose

#: Clouds read before the file is looked at again.
_AT_ONCE = 4
#: Clouds from all over the map that tell where its floor is and how large it looks, before the camera is placed.
_FIRST = 12


class Painter:
    """Knows what was sent, so that only changes are."""

    def __init__(self, on_node: Callable[[int], None], on_link: Callable[[Pair], None]) -> None:
        self._viewer = Viewer()
        scene = self._viewer.scene
        self._nodes = NodeLayer(scene, on_node)
        self._links = LinkLayer(scene, on_link)
        self._paths = PathLayer(scene)
        self._clouds = CloudLayer(scene)
        self._floor = FloorLayer(scene)
        self._frusta = FrustumLayer(scene)
        self._newest = NewestLayer(scene)
        self._highlight = Highlight(scene)
        self._theme: Theme | None = None
        self._framing: Framing | None = None
        self._drawn: tuple[Snapshot, PlacedGraph, Scene] | None = None

    @property
    def port(self) -> int:
        """The port of the viser server."""
        return self._viewer.get_port()

    def close(self) -> None:
        """Close the port."""
        self._viewer.stop()

    def draw(self, snapshot: Snapshot, state: Scene) -> None:
        """Show the map as it is now; clouds that are missing come with ``load_some``."""
        graph = self._graph(snapshot)
        usable = self._usable(snapshot) if state.layers.cloud else ()
        with self._viewer.atomic():
            self._show_theme(state)
            self._clouds.draw(graph, usable, visible=state.layers.cloud)
            self._drawn = (snapshot, graph, state)
            self._draw_graph()
            self._draw_ground()

    def move(self, T_map_base: Pose) -> None:
        """Show the robot here, between two nodes."""
        self._newest.move(T_map_base)

    def load_some(self) -> bool:
        """Send some missing clouds, the newest first; whether more are missing."""
        if self._drawn is None:
            return False
        snapshot, graph, state = self._drawn
        missing = self._clouds.missing if state.layers.cloud else []
        if self._framing is None and len(missing) > _FIRST:
            chosen = [missing[i] for i in np.linspace(0, len(missing) - 1, _FIRST).astype(int)]
        else:
            chosen = missing[: -_AT_ONCE - 1 : -1]
        self._clouds.load(snapshot.reader, chosen)
        more = len(missing) > len(chosen)
        if len(graph) and (self._framing is None or (chosen and not more)):
            with self._viewer.atomic():
                self._draw_ground()
                self._place_camera(snapshot, graph)
        return more

    def _graph(self, snapshot: Snapshot) -> PlacedGraph:
        if self._drawn is not None and self._drawn[0] is snapshot:
            return self._drawn[1]
        return PlacedGraph.of(snapshot)

    @staticmethod
    def _usable(snapshot: Snapshot) -> set[int]:
        """Nodes that have all that a cloud takes."""
        images, depths = (snapshot.reader.nodes_with(kind).tolist() for kind in ("image", "depth"))
        return set(images) & set(depths) & snapshot.calibrated

    def _show_theme(self, state: Scene) -> None:
        look = theme(state.dark)
        if look is not self._theme:
            self._viewer.show_theme(look, dark=state.dark)
            self._theme = look

    def _draw_graph(self) -> None:
        if self._drawn is None:
            return
        snapshot, graph, state = self._drawn
        look, layers, measure = theme(state.dark), state.layers, Measure.of(graph.positions)
        link = (state.selected_link[0], state.selected_link[1]) if state.selected_link else None
        self._nodes.draw(graph, measure.node, state.colour, look, visible=layers.graph)
        self._links.draw(graph, measure.node, look, visible=layers.graph)
        self._paths.draw(graph, measure.dash, look, odometry=layers.odometry, truth=layers.truth)
        self._frusta.draw(graph, measure.frustum, look, visible=layers.frusta)
        self._newest.draw(graph, 1.5 * measure.frustum, look, visible=layers.graph)
        self._highlight.draw(snapshot, graph, state.selected_node, link, measure, look)
        self._floor.draw_grid(snapshot.reader.grid() if layers.grid else None, look, visible=layers.grid)

    def _draw_ground(self) -> None:
        if self._drawn is None:
            return
        _, graph, state = self._drawn
        measure = Measure.of(graph.positions)
        height = floor_height(graph.positions, self._clouds.sample())
        self._floor.draw_ground(height, measure.cell, measure.extent, theme(state.dark))

    def _place_camera(self, snapshot: Snapshot, graph: PlacedGraph) -> None:
        """Where new clients begin; those that are there already keep their camera (viser's page sees to that)."""
        sessions = snapshot.reader.sessions()
        growing = bool(sessions) and not sessions[-1].clean
        framing = frame(graph, self._clouds.sample(), growing=growing)
        if self._framing is not None and not framing.differs(self._framing):
            return
        self._framing = framing
        camera = self._viewer.initial_camera
        camera.position, camera.look_at = framing.position, framing.look_at
        camera.up, camera.fov = np.array([0.0, 0.0, 1.0]), float(FIELD_OF_VIEW)
        camera.far = max(1000.0, 20.0 * framing.distance)
