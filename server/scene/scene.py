"""The 3D view of one map, drawn by one thread."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from server.browse.map_view import MapView
from server.browse.past import PATIENT_S, SHARE_S, Then
from server.browse.snapshot import Pair
from server.scene.changes import changed
from server.scene.colours import NAMED
from server.scene.shown import OptimisedPath, Shown
from server.schemas import LoopWhatIf
from server.schemas.scene import Placing, Scene, SceneChange, SceneLayers
from slam.errors import SlamError
from slam.geometry import Pose
from slam.types import OccupancyGrid

if TYPE_CHECKING:
    from server.scene.painter import Painter

_LOG = logging.getLogger(__name__)

#: A map that is being written is drawn at most this often, one whose past somebody goes through as often as it can be.
_PAUSE_S, _SCRUB_S = 0.15, 0.005
#: A moment that stays this long is drawn with all that takes longer.
_SETTLED_S = 0.25
#: How often to look whether somebody still waits for an answer.
_POLITE_S = 0.02

Tell = Callable[[Scene], None]


class MapScene:
    """Shows a map in a viser server of its own, to one viewer or to as many browsers as look at it.

    Until it is started, and once it is stopped, it is only the state of what is to be shown.

    Attributes:
        view: the map.
        port: of the viser server on 127.0.0.1, once it is started.
    """

    port: int
    _painter: Painter

    def __init__(
        self,
        view: MapView,
        on_select: Callable[[str, tuple[int, ...]], None],
        trial: Callable[[int], LoopWhatIf | None] = lambda _: None,
        on_state: Tell | None = None,
        *,
        dark: bool = True,
        started: bool = True,
    ) -> None:
        """A view; ``trial`` says what a trial would make of the map, ``on_state`` hears what is shown."""
        self.view = view
        self._on_select = on_select
        self._trial = trial
        self._on_state = on_state
        # The moment shown is drawn in full once nobody goes on from it.
        self._incomplete = self._patient = False
        # Later scenes of the same map go on from here, also those of the next server.
        first = time.time_ns() // 1_000_000
        self._state = Scene(layers=SceneLayers(), colour="memory", dark=dark, revision=first)
        self._lock = threading.Lock()
        self._changed = threading.Event()
        self._stale = threading.Event()
        self._looking = threading.Event()
        self._pose: Pose | None = None
        self._closing = threading.Event()
        self._worker: threading.Thread | None = None
        if started:
            self.start()

    @property
    def is_started(self) -> bool:
        """Whether it draws."""
        return self._worker is not None

    @property
    def is_watched(self) -> bool:
        """Whether a browser shows it now."""
        return self.is_started and self._painter.is_watched

    def start(self) -> None:
        """Open the port and draw, unless that is so already."""
        if self.is_started:
            return
        # viser takes a second to load: only who opens a view waits for it.
        from server.scene.painter import Painter

        self._closing.clear()
        self._painter = Painter(self._clicked_node, self._clicked_link)
        self.port = self._painter.port
        self._worker = threading.Thread(target=self._work, name=f"scene {self.view.file.id}", daemon=True)
        self._worker.start()
        self.refresh()

    def refresh(self) -> None:
        """The map's file may have changed: draw it anew, soon."""
        self._stale.set()
        self._changed.set()

    def move(self, T_map_base: Pose | None) -> None:
        """The camera of the run that makes the map is here now; None while it is lost."""
        self._pose = T_map_base
        self._changed.set()

    def look_at_selected(self) -> None:
        """Bring the camera of everybody who looks at this map to the selected node, soon."""
        self._looking.set()
        self._changed.set()

    def state(self) -> Scene:
        """What is shown, and how; another one after each change."""
        with self._lock:
            return self._state

    def change(self, change: SceneChange) -> Scene:
        """Take over what the change names and draw it soon."""
        with self._lock:
            state = self._state = changed(self._state, change)
        self.refresh()
        self._tell()
        return state

    def close(self) -> None:
        """Stop drawing and close the port; what is to be shown is kept."""
        if self._worker is None:
            return
        self._closing.set()
        self._changed.set()
        self._worker.join()
        self._worker = None
        self._painter.close()

    def _clicked_node(self, node_id: int) -> None:
        self.change(SceneChange(selected_node=node_id))
        self._on_select("node", (node_id,))

    def _clicked_link(self, pair: Pair) -> None:
        self.change(SceneChange(selected_link=list(pair)))
        self._on_select("link", pair)

    def _tell(self) -> None:
        if self._on_state is not None:
            self._on_state(self.state())

    def _then(self, state: Scene) -> Then | None:
        """What is shown of the past; what takes long only when somebody stays there."""
        if state.at is None:
            self._incomplete = False
            return None
        probable = state.grid_as == "probability"
        then = self.view.past().at(state.at, with_grid=state.layers.grid, patient=self._patient, probable=probable)
        self._incomplete = not then.is_complete
        return then

    def _floor_plan(self, state: Scene) -> OccupancyGrid | None:
        """That of now: the stored one; where there is none, or none of probabilities, as far as it is put together."""
        if state.at is not None or not state.layers.grid:
            return None
        probable = state.grid_as == "probability"
        stored = None if probable else self.view.reader.grid()
        if stored is not None:
            return stored
        grid, complete = self.view.assembled(PATIENT_S if self._patient else SHARE_S, probable=probable)
        self._incomplete |= not complete
        return grid

    def _placed(self, drawn: Scene, then: Then | None) -> Scene:
        """What is drawn, with where its nodes stand; everybody is told when that is something else than before."""
        if then is None:
            return drawn
        placing: Placing = "then" if then.poses is not None else "now" if then.failure else "soon"
        said = {"placing": placing, "placing_note": then.failure or ""}
        with self._lock:
            # Somebody may have gone on meanwhile: what is told of a moment belongs to that one alone.
            is_news = self._state.at == drawn.at and any(getattr(self._state, name) != said[name] for name in said)
            if is_news:
                self._state = self._state.model_copy(update={**said, "revision": self._state.revision + 1})
            drawn = drawn.model_copy(update={**said, "revision": self._state.revision})
        if is_news:
            self._tell()
        return drawn

    def _optimised(self, state: Scene) -> OptimisedPath | None:
        """The path of the step that somebody looks at."""
        if state.optimised is None or state.at is not None:
            return None
        course = self.view.optimisations.course(self.view.snapshot(), state.optimised.ask)
        return OptimisedPath(course.ids, course.paths[min(state.optimised.step, len(course.paths) - 1)])

    def _values(self, state: Scene) -> Mapping[int, float] | None:
        """What nodes are coloured by, where that is a number of each."""
        return None if state.colour in NAMED else self.view.node_numbers.of(state.colour)

    def _draw(self) -> None:
        pose, self._pose = self._pose, None
        if self._stale.is_set():
            self._stale.clear()
            state = self.state()
            then = self._then(state)
            placed = self._placed(state, then)
            floor = self._floor_plan(state)
            shown = Shown(placed, self._ghosts(state), then, self._optimised(state), floor, self._values(state))
            self._painter.draw(self.view.snapshot(), shown)
        if pose is not None and self._state.at is None:
            self._painter.move(pose)
        if self._looking.is_set():
            self._looking.clear()
            self._painter.look_at_selected()

    def _ghosts(self, state: Scene) -> LoopWhatIf | None:
        """What the map would be, by another threshold or else by a trial."""
        if state.what_if is not None:
            return self.view.what_ifs.at(state.what_if, with_graph=True)
        return None if state.trial is None else self._trial(state.trial)

    def _work(self) -> None:
        """Draw whenever something changed, and send missing clouds, some at a time, whenever nothing did.

        Clouds let pass whoever waits for an answer about the map: they take seconds of the interpreter's time.
        """
        pending = False
        while not self._closing.is_set():
            try:
                if self._changed.wait(timeout=self._idle_s(pending)):
                    self._changed.clear()
                    self._patient = False
                    self._draw()
                elif self._incomplete:
                    self._patient = True
                    self._stale.set()
                    self._draw()
                if not self._changed.is_set():
                    pending = not self._closing.is_set() and (self.view.asked.is_urgent or self._painter.load_some())
            except SlamError as error:
                # The file is gone or can't be read now: what is shown stays, the next change tries again.
                _LOG.warning("the 3D view of %s is not drawn anew: %s", self.view.file.name, error)
                pending = False
            self._closing.wait(0.0 if pending else _PAUSE_S if self._state.at is None else _SCRUB_S)

    def _idle_s(self, pending: bool) -> float | None:
        """How long to wait for a change before something else is done; None where nothing else is to be done."""
        if pending:
            return _POLITE_S if self.view.asked.is_urgent else 0.0
        if not self._incomplete:
            return None
        return 0.0 if self._patient else _SETTLED_S
