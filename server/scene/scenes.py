"""The 3D views of the open maps."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

from server.browse.map_view import MapView
from server.hub import Hub
from server.scene.scene import MapScene
from server.schemas.scene import Scene
from slam.geometry import Pose

_OPEN = 4

OnSelect = Callable[[str, tuple[int, ...]], None]
OnState = Callable[[Scene], None]


class Scenes:
    """One 3D view for each map that somebody looks at, made when it is first asked for."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._lock = threading.Lock()
        self._scenes: OrderedDict[str, MapScene] = OrderedDict()

    def get(self, view: MapView) -> MapScene:
        """The 3D view of a map; the one not asked for the longest is closed when there are too many."""
        with self._lock:
            scene = self._scenes.get(view.file.id)
            if scene is None or scene.view is not view:
                if scene is not None:
                    scene.close()
                scene = self._scenes[view.file.id] = MapScene(
                    view, self._selected(view.file.id), self._changed(view.file.id)
                )
            self._scenes.move_to_end(view.file.id)
            while len(self._scenes) > _OPEN:
                self._scenes.popitem(last=False)[1].close()
            return scene

    def refresh(self, map_id: str) -> None:
        """The graph of a map changed."""
        scene = self._scenes.get(map_id)
        if scene is not None:
            scene.refresh()

    def move(self, map_id: str, T_map_base: Pose | None) -> None:
        """The camera of the run that makes a map moved; None while it is lost."""
        scene = self._scenes.get(map_id)
        if scene is not None:
            scene.move(T_map_base)

    def _selected(self, map_id: str) -> OnSelect:
        """Tells every browser of the map what was clicked."""

        def publish(kind: str, ids: tuple[int, ...]) -> None:
            self._hub.publish("selection", map_id, {"kind": kind, "ids": list(ids)})

        return publish

    def _changed(self, map_id: str) -> OnState:
        """Tells every browser of the map what its 3D view shows now: they share it."""

        def publish(state: Scene) -> None:
            self._hub.publish("scene", map_id, state.model_dump(by_alias=True))

        return publish

    def close(self) -> None:
        """Close all of them."""
        with self._lock:
            while self._scenes:
                self._scenes.popitem()[1].close()
