"""The 3D views of the open maps."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

from server.browse.map_view import MapView
from server.hub import Hub
from server.scene.scene import MapScene
from server.schemas import LoopWhatIf
from server.schemas.scene import Scene
from slam.geometry import Pose

#: So many draw at a time, as long as nobody looks at the others; and at most.
_OPEN, _MOST = 4, 12
#: States that are kept of viewers that may come back.
_KEPT = 100

OnSelect = Callable[[str, tuple[int, ...]], None]
OnState = Callable[[Scene], None]
#: A map, and who looks at it; the empty name stands for everybody who gives none.
Key = tuple[str, str]


class Scenes:
    """A 3D view for each window that looks at a map: layers, selection, ghosts and overlays are its own."""

    def __init__(self, hub: Hub, trial: Callable[[MapView, int], LoopWhatIf | None]) -> None:
        """No view yet; ``trial`` says what a map would be by a trial."""
        self._hub = hub
        self._trial = trial
        self._lock = threading.Lock()
        self._scenes: OrderedDict[Key, MapScene] = OrderedDict()

    def get(self, view: MapView, viewer: str = "") -> MapScene:
        """What a viewer is to see of a map; nothing is drawn before it is shown."""
        with self._lock:
            return self._get(view, viewer)

    def shown(self, view: MapView, viewer: str = "") -> MapScene:
        """The same, drawing; one that nobody looks at any more stops when there are too many."""
        with self._lock:
            scene = self._get(view, viewer)
            scene.start()
            drawing = [one for one in self._scenes.values() if one.is_started and one is not scene]
            idle = [one for one in drawing if not one.is_watched]
            too_many = len(drawing) + 1 - _OPEN
            for one in idle[: max(0, too_many)] or drawing[: max(0, len(drawing) + 1 - _MOST)]:
                one.close()
            return scene

    def _get(self, view: MapView, viewer: str) -> MapScene:
        key = view.file.id, viewer
        scene = self._scenes.get(key)
        if scene is None or scene.view is not view:
            if scene is not None:
                scene.close()
            scene = self._scenes[key] = MapScene(
                view,
                self._selected(*key),
                lambda number: self._trial(view, number),
                self._changed(*key),
                started=False,
            )
        self._scenes.move_to_end(key)
        while len(self._scenes) > _KEPT:
            self._scenes.popitem(last=False)[1].close()
        return scene

    def refresh(self, map_id: str) -> None:
        """The graph of a map changed."""
        for scene in self._of(map_id):
            scene.refresh()

    def move(self, map_id: str, T_map_base: Pose | None) -> None:
        """The camera of the run that makes a map moved; None while it is lost."""
        for scene in self._of(map_id):
            scene.move(T_map_base)

    def _of(self, map_id: str) -> list[MapScene]:
        return [scene for (of, _), scene in list(self._scenes.items()) if of == map_id]

    def _selected(self, map_id: str, viewer: str) -> OnSelect:
        """Tells the browsers of the map what was clicked, and in whose view."""

        def publish(kind: str, ids: tuple[int, ...]) -> None:
            self._hub.publish("selection", map_id, {"kind": kind, "ids": list(ids), "viewer": viewer})

        return publish

    def _changed(self, map_id: str, viewer: str) -> OnState:
        """Tells the browsers of the map what a viewer's 3D view shows now: some of it comes about by itself."""

        def publish(state: Scene) -> None:
            self._hub.publish("scene", map_id, {**state.model_dump(by_alias=True), "viewer": viewer})

        return publish

    def close(self) -> None:
        """Close all of them."""
        with self._lock:
            while self._scenes:
                self._scenes.popitem()[1].close()
