"""Everything that routes work with, and how its parts tell each other of changes."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

from server.browse.edits import edit_result, wanted_covariances, wanted_edit, wanted_prior
from server.browse.journal import decision_result
from server.browse.loops import loops
from server.browse.map_view import MapView
from server.browse.optimising import wanted_optimisation, wanted_turn
from server.browse.parameters import parameter_set
from server.catalog import Catalog
from server.editors import Editors
from server.engine.commands import (
    CancelJob,
    Command,
    Decide,
    DropNodes,
    EditCovariances,
    EditLink,
    EditPrior,
    KeepPoses,
    LabelNodes,
    RunJob,
    SetParams,
    TurnMap,
)
from server.engine.events import Ended, Event, GraphChanged, GridChanged, JobTold, Moved, NodeAdded
from server.errors import EngineError, NotFoundError
from server.hub import Hub
from server.jobs import Jobs
from server.robust import RobustWeights
from server.runs import checked_source
from server.scene.scenes import Scenes
from server.schemas import (
    Covariances,
    Decision,
    DecisionResult,
    Job,
    JobStatus,
    LinkEdit,
    LinkEditResult,
    NodeDrop,
    NodeLabel,
    NodeLabels,
    NodePrior,
    ParameterSet,
    Session,
    StartJob,
    StartRun,
    TakenOver,
    Trial,
)
from server.schemas import KeepPoses as KeepPosesBody
from server.schemas import TurnMap as TurnMapBody
from server.session import RunSession
from server.settings import Settings
from server.trials import TrialRunner
from server.updates import update_message
from slam.database.file_check import is_writable
from slam.effect import Effect
from slam.errors import SlamError
from slam.params import Effect as TakesEffect
from slam.params import Params, Value, spec
from slam.tools.parameters import taken

_OPEN_MAPS = 8
_PRIORS_IGNORED = "Optimizer/PriorsIgnored is on: the prior is stored, and moves no pose until that is switched off"
_NOT_FOR_GOOD = (
    "χ² here is that of all links, also of those that were left out. A later decision, or mapping on, optimises the"
    " graph anew by the map's parameters with all its links, and may move the poses again"
)


class Services:
    """The state of the server; made once for each app, in its event loop's thread."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.hub = Hub()
        self.catalog = Catalog(settings.roots)
        self.session = RunSession(self.hub, self._heard)
        self.editors = Editors(self._heard)
        self.jobs = Jobs(self.hub)
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

    def is_writable(self, view: MapView) -> bool:
        """Whether people may decide about a map."""
        path = view.file.path
        return is_writable(view.reader.version) and os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)

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

    async def decide(self, view: MapView, decision: Decision) -> DecisionResult:
        """Carry out a decision in the process that may write the map."""
        tried = view.tried(decision.pairs) if decision.action == "approve" else ()
        command = Decide(decision.action, decision.pairs, _author(decision.author), decision.preview, tried)
        return self._decided(view, await self._ask(view, command))

    async def edit_link(self, view: MapView, edit: LinkEdit) -> LinkEditResult:
        """Add, refine, edit or reset a link, or say what that would do."""
        outcome = await self._ask(view, EditLink(wanted_edit(edit, _author(edit.author)), edit.preview))
        if edit.preview or outcome.effect is None:
            return edit_result(outcome, None)
        return edit_result(outcome, self._decided(view, outcome.effect).revision)

    async def drop_nodes(self, view: MapView, drop: NodeDrop) -> DecisionResult:
        """Take nodes out of the map, or say what that would do."""
        ids = drop.nodes
        if drop.first is not None and drop.last is not None:
            ids = [i for i in view.snapshot().rows if drop.first <= i <= drop.last]
            if not ids:
                raise NotFoundError(f"the map has no node from {drop.first} to {drop.last}")
        command = DropNodes(tuple(ids), _author(drop.author), drop.preview)
        return self._decided(view, await self._ask(view, command))

    async def label_node(self, view: MapView, node_id: int, label: NodeLabel) -> DecisionResult:
        """Give a node a label, or take it away."""
        return await self.label_nodes(view, NodeLabels(nodes=[node_id], label=label.label, author=label.author))

    async def label_nodes(self, view: MapView, labels: NodeLabels) -> DecisionResult:
        """Give nodes a label, or take theirs away, or say what that would do."""
        command = LabelNodes(tuple(labels.nodes), labels.label, _author(labels.author), labels.preview)
        return self._decided(view, await self._ask(view, command))

    async def edit_prior(self, view: MapView, node_id: int, prior: NodePrior) -> DecisionResult:
        """Give a node a prior, change or remove it, or say what that would do."""
        command = EditPrior(wanted_prior(node_id, prior, _author(prior.author)), prior.preview)
        effect = await self._ask(view, command)
        counts = any(entry.setting is not None for entry in effect.entries) or not self.ignores_priors(view)
        return self._decided(view, effect, "" if counts else _PRIORS_IGNORED)

    def ignores_priors(self, view: MapView) -> bool:
        """Whether no prior moves anything, in the engine that makes the map or by the map's own parameters."""
        in_force = self.session.parameters_of(view.file.id)
        values = dict(view.snapshot().params.items()) if in_force is None else in_force
        return bool(values["Optimizer/PriorsIgnored"])

    async def edit_covariances(self, view: MapView, edit: Covariances) -> DecisionResult:
        """Give many links other covariances, or say what that would do."""
        command = EditCovariances(wanted_covariances(edit, _author(edit.author)), edit.preview)
        return self._decided(view, await self._ask(view, command))

    async def keep_poses(self, view: MapView, body: KeepPosesBody) -> DecisionResult:
        """Make the poses of an optimisation those of the map, or say what that would do."""
        command = KeepPoses(wanted_optimisation(body, _author(body.author)), body.preview)
        return self._decided(view, await self._ask(view, command), _NOT_FOR_GOOD)

    async def turn_map(self, view: MapView, body: TurnMapBody) -> DecisionResult:
        """Turn the whole map as it is, or say what that would do."""
        command = TurnMap(wanted_turn(body, _author(body.author)), body.preview)
        return self._decided(view, await self._ask(view, command))

    async def start_job(self, view: MapView, body: StartJob) -> Job:
        """Begin long work on a map."""
        command = self.jobs.command(body, _author(body.author))
        job = self.jobs.begun(view.file.id, command)
        try:
            await self._ask(view, command)
        except SlamError as error:
            self.jobs.refused(view.file.id, command, error)
            raise
        return self.jobs.of(view.file.id) or job

    async def cancel_job(self, view: MapView) -> JobStatus:
        """Stop the work on a map."""
        await self._ask(view, CancelJob(self.jobs.running(view.file.id).id))
        return JobStatus(job=self.jobs.of(view.file.id))

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
            await self._ask(view, SetParams(changes))
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

    async def _ask(self, view: MapView, command: Command) -> Any:
        """Ask the process that may write a map."""
        if self.session.live_map == view.file.id:
            return await self.session.request(view.file.id, command)
        if not self.is_writable(view):
            raise EngineError(
                f"{view.file.name} can't be changed: the file and its folder must be writable, and of 0.18 or later"
            )
        return await self.editors.request(view.file, command)

    def _decided(self, view: MapView, effect: Effect, note: str = "") -> DecisionResult:
        """What a decision did; everybody is told. That the graph changed its engine has told before it answered."""
        settings = [entry.setting for entry in effect.entries if entry.setting is not None]
        note = "; ".join(
            [note] * bool(note) + [f"{one.name} goes from {one.before} to {one.after}" for one in settings]
        )
        if effect.preview:
            return decision_result(effect, None, note)
        result = decision_result(effect, view.revision, note)
        self.hub.publish("decision", view.file.id, result.model_dump(by_alias=True))
        if settings and self.session.live_map != view.file.id:
            now = Params().changed({one.name: one.after for one in settings})
            self.hub.publish("parameters", view.file.id, {one.name: now.get(one.name) for one in settings})
        return result

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
                result = decision_result(event.effect, None)
                self.hub.publish("decision", map_id, result.model_dump(by_alias=True))
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


def _author(name: str) -> str:
    return name.strip() or "page"
