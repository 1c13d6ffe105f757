"""What people decide about a map, carried out by the process that may write it."""

from __future__ import annotations

import os
from typing import Any

from server.browse.edits import edit_result, wanted_covariances, wanted_edit, wanted_prior
from server.browse.journal import decision_result
from server.browse.map_view import MapView
from server.browse.optimising import wanted_optimisation, wanted_turn
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
    TurnMap,
)
from server.errors import EngineError, NotFoundError
from server.hub import Hub
from server.jobs import Jobs
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
    StartJob,
)
from server.schemas import KeepPoses as KeepPosesBody
from server.schemas import TurnMap as TurnMapBody
from server.session import RunSession
from slam.database.file_check import is_writable
from slam.effect import Effect
from slam.errors import SlamError
from slam.params import Params

_PRIORS_IGNORED = "Optimizer/PriorsIgnored is on: the prior is stored, and moves no pose until that is switched off"
_NOT_FOR_GOOD = (
    "χ² here is that of all links, also of those that were left out. A later decision, or mapping on, optimises the"
    " graph anew by the map's parameters with all its links, and may move the poses again"
)


class Deciding:
    """Asks the engine that makes a map, or else its editor, and tells everybody what was done."""

    def __init__(self, hub: Hub, session: RunSession, editors: Editors, jobs: Jobs) -> None:
        self._hub = hub
        self._session = session
        self._editors = editors
        self._jobs = jobs

    def is_writable(self, view: MapView) -> bool:
        """Whether people may decide about a map."""
        path = view.file.path
        return is_writable(view.reader.version) and os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)

    async def decide(self, view: MapView, decision: Decision) -> DecisionResult:
        """Carry out a decision in the process that may write the map."""
        tried = view.tried(decision.pairs) if decision.action == "approve" else ()
        command = Decide(decision.action, decision.pairs, _author(decision.author), decision.preview, tried)
        return self._decided(view, await self.ask(view, command))

    async def edit_link(self, view: MapView, edit: LinkEdit) -> LinkEditResult:
        """Add, refine, edit or reset a link, or say what that would do."""
        outcome = await self.ask(view, EditLink(wanted_edit(edit, _author(edit.author)), edit.preview))
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
        return self._decided(view, await self.ask(view, command))

    async def label_node(self, view: MapView, node_id: int, label: NodeLabel) -> DecisionResult:
        """Give a node a label, or take it away."""
        return await self.label_nodes(view, NodeLabels(nodes=[node_id], label=label.label, author=label.author))

    async def label_nodes(self, view: MapView, labels: NodeLabels) -> DecisionResult:
        """Give nodes a label, or take theirs away, or say what that would do."""
        command = LabelNodes(tuple(labels.nodes), labels.label, _author(labels.author), labels.preview)
        return self._decided(view, await self.ask(view, command))

    async def edit_prior(self, view: MapView, node_id: int, prior: NodePrior) -> DecisionResult:
        """Give a node a prior, change or remove it, or say what that would do."""
        command = EditPrior(wanted_prior(node_id, prior, _author(prior.author)), prior.preview)
        effect = await self.ask(view, command)
        counts = any(entry.setting is not None for entry in effect.entries) or not self.ignores_priors(view)
        return self._decided(view, effect, "" if counts else _PRIORS_IGNORED)

    def ignores_priors(self, view: MapView) -> bool:
        """Whether no prior moves anything, in the engine that makes the map or by the map's own parameters."""
        in_force = self._session.parameters_of(view.file.id)
        values = dict(view.snapshot().params.items()) if in_force is None else in_force
        return bool(values["Optimizer/PriorsIgnored"])

    async def edit_covariances(self, view: MapView, edit: Covariances) -> DecisionResult:
        """Give many links other covariances, or say what that would do."""
        command = EditCovariances(wanted_covariances(edit, _author(edit.author)), edit.preview)
        return self._decided(view, await self.ask(view, command))

    async def keep_poses(self, view: MapView, body: KeepPosesBody) -> DecisionResult:
        """Make the poses of an optimisation those of the map, or say what that would do."""
        command = KeepPoses(wanted_optimisation(body, _author(body.author)), body.preview)
        return self._decided(view, await self.ask(view, command), _NOT_FOR_GOOD)

    async def turn_map(self, view: MapView, body: TurnMapBody) -> DecisionResult:
        """Turn the whole map as it is, or say what that would do."""
        command = TurnMap(wanted_turn(body, _author(body.author)), body.preview)
        return self._decided(view, await self.ask(view, command))

    async def start_job(self, view: MapView, body: StartJob) -> Job:
        """Begin long work on a map."""
        command = self._jobs.command(body, _author(body.author))
        job = self._jobs.begun(view.file.id, command)
        try:
            await self.ask(view, command)
        except SlamError as error:
            self._jobs.refused(view.file.id, command, error)
            raise
        return self._jobs.of(view.file.id) or job

    async def cancel_job(self, view: MapView) -> JobStatus:
        """Stop the work on a map."""
        await self.ask(view, CancelJob(self._jobs.running(view.file.id).id))
        return JobStatus(job=self._jobs.of(view.file.id))

    async def ask(self, view: MapView, command: Command) -> Any:
        """Ask the process that may write a map."""
        if self._session.live_map == view.file.id:
            return await self._session.request(view.file.id, command)
        if not self.is_writable(view):
            raise EngineError(
                f"{view.file.name} can't be changed: the file and its folder must be writable, and of 0.18 or later"
            )
        return await self._editors.request(view.file, command)

    def _decided(self, view: MapView, effect: Effect, note: str = "") -> DecisionResult:
        """What a decision did; everybody is told. That the graph changed its engine has told before it answered."""
        settings = [entry.setting for entry in effect.entries if entry.setting is not None]
        note = "; ".join(
            [note] * bool(note) + [f"{one.name} goes from {one.before} to {one.after}" for one in settings]
        )
        if effect.preview:
            return decision_result(effect, None, note)
        result = decision_result(effect, view.revision, note)
        self.tell(view.file.id, effect, result)
        return result

    def tell(self, map_id: str, effect: Effect, result: DecisionResult) -> None:
        """Tell everybody of a decision, and of the parameters that went with it."""
        self._hub.publish("decision", map_id, result.model_dump(by_alias=True))
        settings = [entry.setting for entry in effect.entries if entry.setting is not None]
        if settings and self._session.live_map != map_id:
            now = Params().changed({one.name: one.after for one in settings})
            self._hub.publish("parameters", map_id, {one.name: now.get(one.name) for one in settings})


def _author(name: str) -> str:
    return name.strip() or "page"
