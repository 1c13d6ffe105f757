"""The 3D view of one map: a scene that a thread of its own keeps in step with the file."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from server.browse.map_view import MapView
from server.browse.snapshot import Pair, Snapshot
from server.hub import Hub
from server.scene.camera_layer import CameraLayer
from server.scene.cloud_layer import CloudLayer
from server.scene.first_view import set_first_view
from server.scene.grid_plane import GridPlane
from server.scene.link_layer import LinkLayer
from server.scene.model import scene_model
from server.scene.node_layer import NodeLayer
from server.scene.path_layer import PathLayer
from server.scene.selection_layer import SelectionLayer
from server.scene.viewer import add_floor, open_viewer
from server.schemas import Scene, SceneChange, SceneLayers
from slam.camera import Camera
from slam.errors import SlamError
from slam.geometry import Pose

#: Changes that come faster than this are drawn together.
_REST_SECONDS = 0.15


class MapScene:
    """Draws a map; changes come from any thread and are drawn by one.

    Attributes:
        view: the map.
        port: where viser listens, on the loopback.
    """

    def __init__(self, view: MapView, hub: Hub) -> None:
        self.view = view
        self._hub = hub
        self._state = Scene(layers=SceneLayers(), colour="memory")
        self._changed = threading.Condition()
        self._redraw, self._closed = True, False
        self._moves: list[Pose | None] = []
        self._server = open_viewer(view.file.name)
        self.port = self._server.get_port()
        self._nodes = NodeLayer(self._server, self._pick_node)
        self._links = LinkLayer(self._server, self._pick_link)
        self._paths = PathLayer(self._server)
        self._clouds = CloudLayer(self._server, view.reader)
        self._grid = GridPlane(self._server)
        self._cameras = CameraLayer(self._server)
        self._selection = SelectionLayer(self._server, view.reader)
        self._floor = add_floor(self._server, 0.0)
        self._model = scene_model(view.snapshot())
        set_first_view(self._server, self._model)
        self._thread = threading.Thread(target=self._run, name=f"scene-{view.file.id}", daemon=True)
        self._thread.start()

    def state(self) -> Scene:
        """Layers, colours and selection."""
        with self._changed:
            return self._state.model_copy(deep=True)

    def change(self, change: SceneChange) -> Scene:
        """Change some of them; what the change does not name stays."""
        with self._changed:
            layers = {} if change.layers is None else change.layers.model_dump(exclude_none=True)
            update: dict[str, object] = {"layers": self._state.layers.model_copy(update=layers)}
            if change.colour is not None:
                update["colour"] = change.colour
            for name in ("selected_node", "selected_link"):
                if name in change.model_fields_set:
                    update[name] = getattr(change, name)
            self._state = self._state.model_copy(update=update)
            self._wake()
            return self._state.model_copy(deep=True)

    def refresh(self) -> None:
        """The file changed."""
        with self._changed:
            self._wake()

    def move(self, T_map_base: Pose | None) -> None:
        """The camera of the run moved; None while it is lost."""
        with self._changed:
            self._moves = [T_map_base]
            self._changed.notify()

    def close(self) -> None:
        """End the view."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()
        self._server.stop()

    def _wake(self) -> None:
        self._redraw = True
        self._changed.notify()

    def _run(self) -> None:
        more = False
        while True:
            with self._changed:
                while not (self._redraw or self._moves or self._closed or more):
                    self._changed.wait()
                if self._closed:
                    return
                redraw, self._redraw = self._redraw, False
                moves, self._moves = self._moves, []
            for T_map_base in moves:
                self._cameras.move(T_map_base, self._model.step)
            if redraw:
                more = self._try(self._draw)
            elif more:
                more = self._try(self._complete)
            time.sleep(_REST_SECONDS)

    def _try(self, draw: Callable[[], bool]) -> bool:
        """Draw; a file that can't be read now (it is being replaced, or is damaged) leaves the view as it is."""
        try:
            return draw()
        except SlamError:
            return False

    def _draw(self) -> bool:
        """Show the file and the state as they are now; whether clouds are missing."""
        snapshot, state = self.view.snapshot(), self.state()
        self._model = model = scene_model(snapshot)
        layers = state.layers
        self._cameras.use(self._camera(snapshot))
        with self._server.atomic():
            self._nodes.draw(model, state.colour, visible=layers.graph)
            self._links.draw(model, visible=layers.graph)
            self._paths.draw(model, odometry=layers.odometry, truth=layers.truth)
            self._clouds.place(model, visible=layers.cloud)
            self._cameras.draw_frusta(model, visible=layers.frusta)
            self._selection.draw(model, state.selected_node, _as_pair(state.selected_link))
        self._draw_grid(snapshot, layers.grid)
        set_first_view(self._server, model)
        return layers.cloud and self._complete()

    def _complete(self) -> bool:
        """Make some of the clouds that are missing; whether more are."""
        before = self._clouds.floor.height
        more = self._clouds.complete(self._model, lambda: not (self._redraw or self._closed))
        height = self._clouds.floor.height
        if height is not None and height != before:
            self._floor.position = (0.0, 0.0, height)
        if not more and height != before:
            with self._changed:
                self._redraw = self._redraw or self._state.layers.grid
        return more

    def _draw_grid(self, snapshot: Snapshot, visible: bool) -> None:
        grid = snapshot.reader.grid() if visible else None
        self._grid.draw(grid, self._clouds.floor.height or 0.0, visible=visible)

    def _camera(self, snapshot: Snapshot) -> Camera | None:
        calibrated = snapshot.calibrated
        return self.view.reader.camera(max(calibrated)) if calibrated else None

    def _pick_node(self, node_id: int) -> None:
        self._pick(SceneChange(selected_node=node_id, selected_link=None), "node", [node_id])

    def _pick_link(self, from_id: int, to_id: int) -> None:
        self._pick(SceneChange(selected_node=None, selected_link=[from_id, to_id]), "link", [from_id, to_id])

    def _pick(self, change: SceneChange, kind: str, ids: list[int]) -> None:
        self.change(change)
        self._hub.publish("selection", self.view.file.id, {"kind": kind, "ids": ids})


def _as_pair(ids: list[int] | None) -> Pair | None:
    return None if ids is None else (ids[0], ids[1])
