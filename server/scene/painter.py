"""Draws a map with all its layers into a viser server; called by one thread."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from server.browse.past import Then
from server.browse.snapshot import Pair, Snapshot
from server.scene.closeup import CloseUpLayer
from server.scene.clouds import CloudLayer
from server.scene.colours import Theme, theme
from server.scene.floor import FloorLayer, floor_height
from server.scene.framing import FIELD_OF_VIEW, Framing, beside, frame
from server.scene.frusta import FrustumLayer
from server.scene.ghosts import GhostLayer, pairs_of
from server.scene.highlight import Highlight
from server.scene.hypothesis import HypothesisLayer
from server.scene.landmarks import LandmarkLayer
from server.scene.links import LinkLayer
from server.scene.measure import Measure
from server.scene.model import ModelLayer
from server.scene.newest import NewestLayer
from server.scene.nodes import NodeLayer
from server.scene.optimised import OptimisedLayer
from server.scene.overlay import OverlayLayer
from server.scene.paths import PathLayer
from server.scene.placed import PlacedGraph
from server.scene.shown import Shown
from server.scene.viewer import Viewer
from server.schemas import LoopWhatIf
from server.schemas.scene import Scene, SceneLayers
from slam.geometry import Pose
from slam.loop.foresight import Outcome

#: Clouds read before the file is looked at again, one while somebody goes through its past.
_AT_ONCE = 4
#: Clouds from all over the map that tell where its floor is and how large it looks, before the camera is placed.
_FIRST = 12
#: A newest pose is shown this much larger than other cameras.
_NEWEST = 1.5
#: What viser's page has as the farthest visible distance; wider maps need more.
_FAR_M = 1000.0


@dataclass(frozen=True, eq=False)
class Picture:
    """A map and how it is to be shown; with a moment, as it was then."""

    snapshot: Snapshot
    graph: PlacedGraph
    wanted: Shown
    measure: Measure

    @property
    def state(self) -> Scene:
        """Layers, colours and selection."""
        return self.wanted.state

    @property
    def then(self) -> Then | None:
        """The moment that is shown; None for now."""
        return self.wanted.then

    @property
    def ghosts(self) -> LoopWhatIf | None:
        """What another threshold would mean for the map of now."""
        return self.wanted.ghosts if self.then is None else None

    @property
    def look(self) -> Theme:
        """Its colours."""
        return theme(self.state.dark)

    @cached_property
    def _present(self) -> PlacedGraph:
        """The part of the graph that was there."""
        return self.graph if self.then is None else self.graph.then(self.then.moment, self.then.poses)

    @cached_property
    def shown(self) -> PlacedGraph:
        """Of that the sessions that are not hidden."""
        hidden = self.state.hidden_sessions
        return self._present.without_sessions(hidden) if hidden else self._present

    @cached_property
    def placed(self) -> PlacedGraph:
        """All nodes where they are shown: those of then where they were, and out of sight those that came later."""
        if self.then is None or self.then.poses is None:
            return self.graph
        T_map = self.graph.T_map.copy()
        T_map[: len(self._present)] = self._present.T_map
        return replace(self.graph, T_map=T_map)

    @property
    def landmarks(self) -> Mapping[int, Pose]:
        """Those that a node which is shown has seen."""
        poses = {i: T for i, T in self.snapshot.poses.items() if i < 0}
        if not poses or self.shown is self.graph:
            return poses
        seen = {link.to_id for link in self.snapshot.constraints if link.from_id in self.shown.rows}
        return {i: T for i, T in poses.items() if i in seen}

    @property
    def until(self) -> int | None:
        """The last node that was there; None for all."""
        return None if self.then is None else self.then.moment.at

    @property
    def alone(self) -> bool:
        """Whether the selected node is shown without the map."""
        return self.state.alone and self.state.selected_node in self.shown.rows

    @property
    def layers(self) -> SceneLayers:
        """The layers of the map: none around a node that is alone."""
        if not self.alone:
            return self.state.layers
        return SceneLayers(**dict.fromkeys(SceneLayers.model_fields, False))


class Painter:
    """Shows maps and their changes; each layer knows what it sent and sends only what is new."""

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
        self._hypothesis = HypothesisLayer(scene)
        self._landmarks = LandmarkLayer(scene)
        self._model = ModelLayer(scene)
        self._ghosts = GhostLayer(scene)
        self._optimised = OptimisedLayer(scene)
        self._overlay = OverlayLayer(scene)
        self._closeup = CloseUpLayer(scene)
        self._highlight = Highlight(scene)
        self._framing: Framing | None = None
        self._shown: Picture | None = None

    @property
    def port(self) -> int:
        """The port of the viser server."""
        return self._viewer.get_port()

    @property
    def is_watched(self) -> bool:
        """Whether a browser is connected."""
        return bool(self._viewer.get_clients())

    def close(self) -> None:
        """Close the port."""
        self._viewer.stop()

    def draw(self, snapshot: Snapshot, wanted: Shown) -> None:
        """Show the map as it is now, with what it could be beside it, or as it was at a moment.

        Missing clouds come with ``load_some``.
        """
        before, state = self._shown, wanted.state
        if before is not None and before.snapshot is snapshot:
            graph, measure = before.graph, before.measure
        else:
            graph = PlacedGraph.of(snapshot)
            measure = Measure.of(graph.positions)
        picture = Picture(snapshot, graph, wanted, measure)
        shown = None if picture.shown is graph else picture.shown.rows
        with_images = snapshot.pictured if state.layers.cloud else frozenset()
        with_scans = snapshot.scanned if state.layers.cloud else frozenset()
        with self._viewer.atomic():
            if before is None or before.look is not picture.look:
                self._viewer.show_theme(picture.look, dark=state.dark)
            overlaid = self._overlay.draw(
                snapshot, graph, _selection(state)[1], state.overlay, picture.look, of=state.overlay_of
            )
            visible = picture.layers.cloud and not overlaid
            self._clouds.draw(picture.placed, with_images, with_scans, visible=visible, shown=shown)
            self._draw_graph(picture)
            self._highlight.draw(
                snapshot,
                picture.shown,
                *_selection(state),
                picture.measure,
                picture.look,
                frustum="frustum" in state.node_parts,
                # What it was made into is behind the image.
                image=not {"cloud", "mesh", "elevation"} & {*state.node_parts},
            )
            self._model.draw(snapshot.reader, snapshot.revision, visible=picture.layers.model)
            self._draw_grid(picture)
            # It is that of the map of now, at any moment; when clouds have come ``load_some`` draws it again.
            if before is None or before.graph is not graph or before.look is not picture.look:
                self._draw_ground(picture)
            self._closeup.draw(
                snapshot.reader,
                snapshot.revision,
                picture.shown,
                state.selected_node,
                state.node_parts,
                self._floor.height,
                picture.look,
                state.depth,
            )
        self._shown = picture

    def look_at_selected(self) -> None:
        """Bring every camera to where the selected node looks."""
        picture = self._shown
        node = None if picture is None else picture.state.selected_node
        if picture is None or node is None or node not in picture.shown.rows:
            return
        framing = beside(picture.shown.T_map[picture.shown.rows[node]])
        for client in self._viewer.get_clients().values():
            with client.atomic():
                client.camera.position, client.camera.look_at = framing.position, framing.look_at

    def move(self, T_map_base: Pose) -> None:
        """Show the robot here, between two nodes."""
        self._newest.move(T_map_base)

    def load_some(self) -> bool:
        """Send some missing clouds, the newest first; whether more are missing."""
        picture = self._shown
        if picture is None or not len(picture.graph):
            return False
        missing = self._clouds.missing if picture.state.layers.cloud else []
        chosen = missing[: -(_AT_ONCE if picture.then is None else 1) - 1 : -1]
        if self._framing is None and len(missing) > _FIRST:
            chosen = [missing[i] for i in np.linspace(0, len(missing) - 1, _FIRST).astype(int)]
        self._clouds.load(picture.snapshot.reader, chosen)
        more = len(missing) > len(chosen)
        if self._framing is None or (chosen and not more):
            with self._viewer.atomic():
                self._draw_ground(picture)
                self._place_camera(picture)
        return more

    def _draw_graph(self, picture: Picture) -> None:
        graph, moment = picture.shown, None if picture.then is None else picture.then.moment
        hidden, values = picture.state.hidden_links, picture.wanted.values
        look, layers, measure = picture.look, picture.layers, picture.measure
        T_map_base = None if moment is None else moment.T_map_base
        self._nodes.draw(graph, measure.node, picture.state.colour, look, visible=layers.graph, values=values)
        going = pairs_of(picture.ghosts, Outcome.GOES)
        self._links.draw(graph.without(going), measure.node, look, visible=layers.graph, hidden=hidden)
        self._ghosts.draw(graph, picture.ghosts, measure, look, visible=layers.graph)
        self._optimised.draw(graph, picture.wanted.optimised, measure.dash, look, visible=layers.graph)
        self._paths.draw(
            picture.placed, measure.dash, look, odometry=layers.odometry, truth=layers.truth, until=picture.until
        )
        self._frusta.draw(graph, measure.frustum, look, visible=layers.frusta)
        landmarks = layers.graph and "landmark" not in hidden
        self._landmarks.draw(picture.landmarks, measure.frustum, visible=landmarks)
        self._newest.draw(graph, _NEWEST * measure.frustum, look, visible=layers.graph, T_map_base=T_map_base)
        self._hypothesis.draw(graph, moment, measure.node, look, visible=layers.graph)

    def _draw_grid(self, picture: Picture) -> None:
        then, shown, how = picture.then, picture.layers.grid, picture.wanted.state.grid_as
        grid = picture.wanted.floor if then is None else then.grid
        self._floor.draw_grid(grid, picture.look, visible=shown, sharp=then is None or then.is_complete, how=how)

    def _draw_ground(self, picture: Picture) -> None:
        height = floor_height(picture.graph.positions, self._clouds.sample())
        self._floor.draw_ground(height, picture.measure.cell, picture.measure.extent, picture.look)

    def _place_camera(self, picture: Picture) -> None:
        """Where new clients begin; those that are there already keep their camera (viser's page sees to that)."""
        sessions = picture.snapshot.reader.sessions()
        growing = bool(sessions) and not sessions[-1].clean
        framing = frame(picture.graph, self._clouds.sample(), growing=growing)
        if self._framing is not None and not framing.differs(self._framing):
            return
        self._framing = framing
        camera = self._viewer.initial_camera
        camera.position, camera.look_at = framing.position, framing.look_at
        camera.up, camera.fov = (0.0, 0.0, 1.0), float(FIELD_OF_VIEW)
        camera.far = max(_FAR_M, 20.0 * framing.distance)


def _selection(state: Scene) -> tuple[int | None, Pair | None]:
    pair = state.selected_link
    return state.selected_node, None if pair is None else (pair[0], pair[1])
