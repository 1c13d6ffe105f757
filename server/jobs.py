"""Long work on maps: at most one job for each map, and what is known of the last one."""

from __future__ import annotations

import itertools

from server.browse.edits import link_types
from server.browse.journal import decision_result
from server.engine.commands import StartJob
from server.engine.events import Ended, Event, JobTold
from server.errors import EngineError, NotFoundError
from server.hub import Hub
from server.schemas import DetectOptions, Job, RefineOptions
from server.schemas import StartJob as StartJobBody
from server.schemas.edits import JobKind
from slam.edit.wishes import Detection, Refinement, Regrid
from slam.errors import SlamError

#: Lines of a log that are kept.
_LINES = 200


class Jobs:
    """Follows the jobs of all maps and tells everybody; lives in the server's event loop."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._numbers = itertools.count(1)
        self._last: dict[str, Job] = {}

    def of(self, map_id: str) -> Job | None:
        """The last job of a map."""
        return self._last.get(map_id)

    def running(self, map_id: str) -> Job:
        """The job that is at work on a map; raises NotFoundError when there is none."""
        job = self._last.get(map_id)
        if job is None or job.state != "running":
            raise NotFoundError(f"no job is at work on {map_id}")
        return job

    def command(self, body: StartJobBody, author: str) -> StartJob:
        """What the engine is asked for."""
        if body.detect is not None:
            return StartJob(next(self._numbers), _detection(body.detect), author)
        if body.regrid is not None:
            return StartJob(next(self._numbers), Regrid(**body.regrid.model_dump()), author)
        return StartJob(next(self._numbers), _refinement(body.refine or RefineOptions()), author)

    def begun(self, map_id: str, command: StartJob) -> Job:
        """A job that the engine is about to be asked for, so that none of its events is missed.

        Raises:
            EngineError: one is at work on the map.
        """
        job = self._last.get(map_id)
        if job is not None and job.state == "running":
            raise EngineError(f"a job is at work on {map_id}: wait until it has ended, or cancel it")
        job = Job(id=command.number, kind=_kind(command), state="running", share=0, log=[], message="", decision=None)
        self._tell(map_id, job)
        return job

    def refused(self, map_id: str, command: StartJob, error: SlamError) -> None:
        """The engine did not take it up: it failed before it began."""
        job = self._last.get(map_id)
        if job is not None and job.id == command.number and job.state == "running":
            self._tell(map_id, job.model_copy(update={"state": "failed", "message": str(error)}))

    def heard(self, map_id: str, event: Event) -> None:
        """An engine told something about a map."""
        job = self._last.get(map_id)
        if job is None or job.state != "running":
            return
        if isinstance(event, Ended):
            why = str(event.error) if event.error is not None else "the map was closed before it had ended"
            self._tell(map_id, job.model_copy(update={"state": "failed", "message": why}))
        elif isinstance(event, JobTold) and event.number == job.id:
            self._tell(map_id, _followed(job, event))

    def _tell(self, map_id: str, job: Job) -> None:
        self._last[map_id] = job
        self._hub.publish("job", map_id, job.model_dump(by_alias=True))


def _followed(job: Job, event: JobTold) -> Job:
    return job.model_copy(
        update={
            "state": event.state,
            "share": event.share,
            "log": [*job.log, *event.lines][-_LINES:],
            "message": "" if event.error is None else str(event.error),
            "decision": None if event.effect is None else decision_result(event.effect, None),
        }
    )


def _kind(command: StartJob) -> JobKind:
    if isinstance(command.wanted, Detection):
        return "detect"
    return "regrid" if isinstance(command.wanted, Regrid) else "refine"


def _detection(options: DetectOptions) -> Detection:
    return Detection(**options.model_dump())


def _refinement(options: RefineOptions) -> Refinement:
    return Refinement(**{**options.model_dump(), "types": link_types(options.types)})
