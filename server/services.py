"""Everything that routes work with, and how its parts tell each other of changes."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress

from server.browse.journal import decision_result
from server.browse.loops import loops
from server.browse.map_view import MapView
from server.browse.parameters import parameter_set
from server.catalog import Catalog
from server.deciding import Deciding
from server.editors import Editors
from server.engine.commands import (
    RunJob,
    SetParams,
)
from server.engine.events import Ended, Event, GraphChanged, GridChanged, JobTold, Moved, NodeAdded
from server.errors import EngineError
from server.hub import Hub
from server.jobs import Jobs
from server.robust import RobustWeights
from server.runs import checked_source
from server.scene.scenes import Scenes
from server.schemas import (
    ParameterSet,
    Session,
    StartRun,
    TakenOver,
    Trial,
)
from server.session import RunSession
from server.settings import Settings
from server.trials import TrialRunner
from server.updates import update_message
from slam.errors import SlamError
from slam.params import Effect as TakesEffect
from slam.params import Value, spec
from slam.tools.parameters import taken

_OPEN_MAPS = 8


class Services:
    """The state of the server; made once for each app, in its event loop's thread."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.hub = Hub()
        self.catalog = Catalog(settings.roots)
        self.session = RunSession(self.hub, self._heard)
        self.editors = Editors(self._heard)
        self.jobs = Jobs(self.hub)
        self.deciding = Deciding(self.hub, self.session, self.editors, self.jobs)
        self.trials = TrialRunner(self.hub, settings.scratch)
        self.scenes = Scenes(self.hub, self.trials.ghosts)
        self.robust = RobustWeights(self.hub)
        self._views: OrderedDict[tuple[str, int], MapView] = OrderedDict()
        self._lock = threading.Lock()

    def view(self, map_id: str) -> MapView:
        """The map of an id; raises UnknownMapError or DatabaseError."""
        file = self.catalog.find(map_id)
        # A file that was replaced by another of its name is another map.
        key = (map_id, file.path.stat().st_ino)
        with self._lock:
            view = self._views.get(key)
            if view is None:
                view = self._views[key] = MapView(file)
            self._views.move_to_end(key)
            while len(self._views) > _OPEN_MAPS:
                self._views.popitem(last=False)
            return view

    def read_ahead(self) -> None:
        """Work out the review queue of the map that was written last: it is the likeliest to be asked for."""
        # A map that can't be read is none to work ahead for: whoever asks for it is told.
        with suppress(SlamError, OSError):
            newest = max(self.catalog.files(), key=lambda file: file.path.stat().st_mtime_ns, default=None)
            if newest is not None:
                loops(self.view(newest.id).snapshot())

    async def start_run(self, run: StartRun) -> Session:
        """Start mapping into a new map under the first served folder, or into one that is there."""
        source, params = checked_source(run.source, self.settings.sources), dict(run.params)
        if run.mode == "new":
            path = self.catalog.new_path(run.map)
            return await self.session.start(run.map, RunJob(source, path, params, run.seed, run.speed))
        file = self.catalog.find(run.map)
        await self.editors.release(file)
        if run.mode == "localize":
            params["Mem/IncrementalMemory"] = False
        job = RunJob(source, file.path, params, run.seed, run.speed, append=run.mode == "append")
        return await self.session.start(file.id, job)

    def parameters(self, view: MapView) -> ParameterSet:
        """All parameters: as the engine has them while it runs, else as the file has them."""
        snapshot = view.snapshot()
        in_force = self.session.parameters_of(view.file.id)
        values = dict(snapshot.params.items()) if in_force is None else in_force
        return parameter_set(values, snapshot.parameter_texts, live=in_force is not None)

    async def change_parameters(self, view: MapView, changes: Mapping[str, Value]) -> ParameterSet:
        """Change parameters of the engine that runs, else those of the file, with which its next session starts."""
        if self.session.live_map == view.file.id:
            await self.session.set_parameters(view.file.id, changes)
        else:
            await self.deciding.ask(view, SetParams(changes))
            # What decides from now on goes by the new ones.
            await self.editors.release(view.file)
            self._graph_changed(view.file.id)
        answer = self.parameters(view)
        named = {one.name: one.value for one in answer.parameters if one.name in changes}
        self.hub.publish("parameters", view.file.id, named)
        return answer

    def start_trial(self, view: MapView, changes: Mapping[str, Value]) -> Trial:
        """Try parameters on a map, beside those that are in force."""
        said = taken(view.reader).params
        in_force = self.session.parameters_of(view.file.id) or dict(view.snapshot().params.items())
        base = {name: value for name, value in in_force.items() if value != said.get(name)}
        return self.trials.start(view, changes, base)

    async def take_over(self, view: MapView, number: int) -> TakenOver:
        """Give a map the parameters of a trial; a running engine those that can change while it maps."""
        changes = {one.name: one.value for one in self.trials.outcome(view, number).trial.changes}
        live = self.session.live_map == view.file.id
        left = [name for name in changes if live and spec(name).effect is not TakesEffect.LIVE]
        applied = {name: value for name, value in changes.items() if name not in left}
        if not applied:
            raise EngineError(f"{left[0]} takes effect with the {spec(left[0]).effect.value}: stop the run first")
        answer = await self.change_parameters(view, applied)
        return TakenOver(parameters=answer, applied=sorted(applied), left=left)

    def keep_trial(self, view: MapView, number: int, name: str) -> str:
        """Make a map file of a trial; the id of the new map."""
        path = self.catalog.new_path(name)
        self.trials.keep(view, number, path)
        return next(file.id for file in self.catalog.files() if file.path == path)

    async def close(self) -> None:
        """End every process and every 3D view."""
        await self.session.close()
        await self.editors.close()
        self.scenes.close()
        self.robust.close()
        self.trials.close()

    def _heard(self, map_id: str, event: Event) -> None:
        """An engine told something about a map."""
        if isinstance(event, NodeAdded):
            self.hub.publish("update", map_id, update_message(event))
            self._graph_changed(map_id)
        elif isinstance(event, GraphChanged):
            self._graph_changed(map_id)
        elif isinstance(event, GridChanged):
            self._grid_changed(map_id)
        elif isinstance(event, JobTold | Ended):
            self.jobs.heard(map_id, event)
            if isinstance(event, JobTold) and event.effect is not None:
                self.deciding.tell(map_id, event.effect, decision_result(event.effect, None))
        elif isinstance(event, Moved):
            self.scenes.move(map_id, event.T_map_base)

    def _graph_changed(self, map_id: str) -> None:
        """Tell everybody, with the revision that the file will be read as."""
        view = self._opened(map_id)
        revision = 1 if view is None else view.touch()
        self.hub.publish("graph", map_id, {"revision": revision})
        self.scenes.refresh(map_id)

    def _grid_changed(self, map_id: str) -> None:
        """Show the new floor plan; all else that was read of the file still holds."""
        view = self._opened(map_id)
        if view is not None:
            view.grid_written()
        self.scenes.refresh(map_id)

    def _opened(self, map_id: str) -> MapView | None:
        with self._lock:
            return next((view for (open_id, _), view in self._views.items() if open_id == map_id), None)
