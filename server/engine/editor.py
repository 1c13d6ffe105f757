"""A map that is only looked at, open for writing as long as people decide about it."""

from __future__ import annotations

from pathlib import Path

from server.engine.channel import Channel
from server.engine.commands import CancelJob, Decide, Edit, EditJob, Request, SetParams, StartJob, Stop
from server.engine.decision import carry_out
from server.engine.edits import Edits
from server.engine.events import Ended, GraphChanged, GridChanged, Started
from server.engine.opened import Opened, opened
from server.engine.running_job import RunningJob
from server.errors import EngineError
from slam.edit.wishes import Outcome
from slam.effect import Effect
from slam.errors import SlamError

#: Without a decision for this long the map is closed, and free for other writers.
_IDLE_SECONDS = 30.0
#: Decisions that follow each other faster than this share one new grid.
_REST_SECONDS = 0.5


class Editor:
    """Carries out decisions, edits and jobs on one existing map; one job at a time, and nothing else meanwhile."""

    def __init__(self, job: EditJob, channel: Channel) -> None:
        self._path: Path = job.path
        self._channel = channel
        self._job: RunningJob | None = None

    def run(self) -> Ended:
        """Decide until nobody asks any more."""
        with opened(self._path) as map_file:
            self._edits = Edits(map_file.review, map_file.reader)
            self._channel.send(Started("", None, dict(map_file.params.items())))
            self._serve(map_file)
        return Ended("stopped")

    def _serve(self, map_file: Opened) -> None:
        grid = map_file.grid
        while True:
            busy = self._job is not None or grid.is_begun
            request = self._channel.next(0 if busy else _REST_SECONDS if grid.is_due else _IDLE_SECONDS)
            stopping = request is not None and isinstance(request.command, Stop)
            if stopping and self._job is not None:
                self._job.cancel()
            if request is None and self._job is not None:
                self._work(map_file, self._job)
            elif grid.is_due and (request is None or stopping):
                # Node by node, so that a decision does not wait for it; once nobody can ask any more, at once.
                if grid.carry_out() if stopping else grid.step():
                    self._channel.send(GridChanged())
            elif request is None:
                return
            if stopping:
                return
            if request is not None:
                self._attend(map_file, request)

    def _work(self, map_file: Opened, job: RunningJob) -> None:
        job.step()
        if job.is_over:
            self._job = None
            if job.effect is not None:
                self._changed(map_file, job.effect)

    def _attend(self, map_file: Opened, request: Request) -> None:
        try:
            if isinstance(request.command, StartJob | CancelJob):
                self._steer(request.command)
                self._channel.answer(request)
            else:
                self._decide(map_file, request)
        except SlamError as error:
            self._channel.refuse(request, error)

    def _steer(self, command: StartJob | CancelJob) -> None:
        if isinstance(command, StartJob):
            self._require_rest()
            self._job = RunningJob(command.number, self._edits.job(command), self._channel)
            return
        if self._job is None or self._job.number != command.number:
            raise EngineError(f"job {command.number} is not running: there is nothing to cancel")
        self._job.cancel()
        self._job = None

    def _decide(self, map_file: Opened, request: Request) -> None:
        self._require_rest()
        command = request.command
        answer: Outcome | Effect | None
        if isinstance(command, Decide):
            answer = carry_out(map_file.review, command)
            changed = not command.preview
        elif isinstance(command, Edit):
            answer = self._edits.carry_out(command)
            changed = not command.preview
        elif isinstance(command, SetParams):
            map_file.writer.change_parameters(command.changes)
            answer, changed = None, False
        else:
            raise EngineError(f"no engine is mapping {self._path.name}: start a run first")
        # Who asked is answered once everybody has been told.
        if changed:
            self._changed(map_file, answer.effect if isinstance(answer, Outcome) else answer)
        self._channel.answer(request, answer)

    def _changed(self, map_file: Opened, effect: Effect | None) -> None:
        if effect is not None and any(entry.grids is not None for entry in effect.entries):
            map_file.grid.locals_changed()
        else:
            map_file.grid.poses_changed()
        self._channel.send(GraphChanged())

    def _require_rest(self) -> None:
        if self._job is not None:
            raise EngineError(f"a job is at work on {self._path.name}: wait until it has ended, or cancel it")
