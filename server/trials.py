"""Trials of parameters on maps: carried out in a process of their own, kept in a scratch folder until discarded."""

from __future__ import annotations

import hashlib
import json
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from shutil import rmtree
from typing import Any

from server.browse.map_view import MapView
from server.browse.trial_ghosts import ghosts_of
from server.engine.nursery import nursery
from server.engine.trial import MAP, NODES, OUTCOME, TrialJob, trial_main
from server.errors import EngineError, NotFoundError
from server.hub import Hub
from server.schemas import LoopWhatIf, Trial, TrialChange, TrialComparison, TrialOutcome
from slam.errors import DatabaseError, SlamError
from slam.params import Params, Value
from slam.saving import save
from slam.tools.kept import keep
from slam.tools.wanted import Wanted, check

_RECORD = "trial.json"
#: Folders of the trial's user alone: maps are nobody else's business.
_MODE = 0o700
#: Longest time to wait until a process that was killed is gone.
_STOP_SECONDS = 10.0


@dataclass(slots=True, eq=False)
class _Work:
    """The trial that is under way."""

    map_id: str
    folder: Path
    trial: Trial
    of: str
    process: BaseProcess
    cancelled: bool = False
    ended: threading.Event = field(default_factory=threading.Event)


class TrialRunner:
    """At most one trial at a time on this server, as each takes a core; what they left is found again after a restart.

    A map has a folder under ``scratch``, by its path: the replay as it was, shared by its trials while the map does not
    change, and a numbered folder for each trial. One without its record was never finished.
    """

    def __init__(self, hub: Hub, scratch: Path) -> None:
        self._hub = hub
        self._scratch = scratch
        self._lock = threading.Lock()
        self._work: _Work | None = None

    def start(self, view: MapView, changes: Mapping[str, Value], base: Mapping[str, Value]) -> Trial:
        """Begin a trial; ``base`` are values in force that the map file does not tell.

        Raises:
            EngineError: one is under way.
            SlamError: a parameter is refused, or the scratch folder can't be written.
        """
        wanted = Wanted(view.file.path, changes, base)
        before, after = check(wanted)
        with self._lock:
            self._require_rest()
            home, of = self._home(view), _state_of(view.file.path, base)
            number = max((one.number for one, _ in _records(home)), default=0) + 1
            folder, baseline = home / str(number), home / f"as-it-was-{of}.db"
            _prepare(home, folder, baseline)
            trial = _begun(number, changes, before, after)
            context = nursery()
            ours, theirs = context.Pipe(duplex=False)
            process = context.Process(target=trial_main, args=(theirs, TrialJob(wanted, baseline, folder)), daemon=True)
            process.start()
            theirs.close()
            work = self._work = _Work(view.file.id, folder, trial, of, process)
        threading.Thread(target=self._follow, args=(work, ours), name="slamdeck-trial", daemon=True).start()
        return trial

    def of(self, view: MapView) -> list[Trial]:
        """The trials of a map, the newest first."""
        found = [_aged(one, of, view) for one, of in _records(self._home(view))]
        with self._lock:
            if self._work is not None and self._work.map_id == view.file.id:
                found.append(self._work.trial)
        return sorted(found, key=lambda one: -one.number)

    def outcome(self, view: MapView, number: int) -> TrialOutcome:
        """A trial with what came of it; NotFoundError when there is none of this number."""
        trial = next((one for one in self.of(view) if one.number == number), None)
        if trial is None:
            raise NotFoundError(f"{view.file.name} has no trial {number}: it may have been discarded or cancelled")
        if trial.state != "done":
            return TrialOutcome(trial=trial, comparison=None)
        path = self._home(view) / str(number) / OUTCOME
        try:
            return TrialOutcome(trial=trial, comparison=TrialComparison.model_validate_json(path.read_bytes()))
        except (OSError, ValueError) as error:
            raise DatabaseError(f"{path} can't be read: discard trial {number} and try again") from error

    def ghosts(self, view: MapView, number: int) -> LoopWhatIf | None:
        """What the map would be by a trial, as the 3D view draws it; None where the trial is gone or not done."""
        if not any(one.number == number and one.state == "done" for one in self.of(view)):
            return None
        found = self.outcome(view, number).comparison
        return None if found is None else ghosts_of(found)

    def cancel(self, view: MapView, number: int) -> None:
        """Stop a trial; nothing of it stays. NotFoundError when it is not under way."""
        with self._lock:
            work = self._work
            if work is None or work.map_id != view.file.id or work.trial.number != number:
                raise NotFoundError(f"trial {number} of {view.file.name} is not under way: there is nothing to cancel")
            work.cancelled = True
            work.process.kill()
        work.ended.wait(_STOP_SECONDS)

    def discard(self, view: MapView, number: int) -> None:
        """Forget a trial; NotFoundError when there is none, EngineError while it is under way."""
        trial = self.outcome(view, number).trial
        if trial.state == "running":
            raise EngineError(f"trial {number} is under way: cancel it")
        home = self._home(view)
        rmtree(home / str(number), ignore_errors=True)
        if not _records(home):
            self._clear(view)
        self._hub.publish("trial", view.file.id, None)

    def keep(self, view: MapView, number: int, output: Path) -> None:
        """Make a map file of a trial, with the images of the map.

        Raises:
            EngineError: it is not done.
            DatabaseError: the file is there already or can't be made, or the map is another one by now.
        """
        trial = self.outcome(view, number).trial
        if trial.state != "done":
            raise EngineError(f"trial {number} has no map that could be kept: it is {trial.state}")
        folder = self._home(view) / str(number)
        nodes = {int(new): int(old) for new, old in json.loads((folder / NODES).read_text("utf-8")).items()}
        keep(folder / MAP, nodes, view.file.path, output)

    def close(self) -> None:
        """Give up what is under way."""
        with self._lock:
            if self._work is not None:
                self._work.cancelled = True
                self._work.process.kill()

    def _follow(self, work: _Work, answers: Connection[Any, Any]) -> None:
        error: SlamError | None = EngineError("the trial's process has ended before it was done")
        try:
            while isinstance(told := answers.recv(), tuple):
                share, text = told
                work.trial = work.trial.model_copy(update={"share": share, "text": text})
                self._tell(work)
            error = told
        except (EOFError, OSError):
            work.process.join()
        with self._lock:
            self._end(work, error)
            self._work = None
        work.ended.set()
        self._tell(work)

    def _end(self, work: _Work, error: SlamError | None) -> None:
        if work.cancelled:
            rmtree(work.folder, ignore_errors=True)
            return
        seconds = round(time.time() - work.trial.started, 1)
        state = (
            {"state": "done", "share": 1.0, "text": ""} if error is None else {"state": "failed", "text": str(error)}
        )
        work.trial = work.trial.model_copy(update={**state, "seconds": seconds})
        try:
            save(work.folder / _RECORD, json.dumps({"of": work.of, "trial": work.trial.model_dump()}))
        except DatabaseError as failure:
            work.trial = work.trial.model_copy(update={"state": "failed", "text": str(failure)})

    def _tell(self, work: _Work) -> None:
        self._hub.publish("trial", work.map_id, None if work.cancelled else work.trial.model_dump())

    def _require_rest(self) -> None:
        if self._work is not None:
            raise EngineError(
                f"trial {self._work.trial.number} of {self._work.map_id} is under way, and one at a time is carried"
                " out: wait until it has ended, or cancel it there, under Params, Trials"
            )

    def _clear(self, view: MapView) -> None:
        """The last trial of a map is gone: so is its replay as it was, unless another has begun to use it."""
        with self._lock:
            if self._work is None or self._work.map_id != view.file.id:
                rmtree(self._home(view), ignore_errors=True)

    def _home(self, view: MapView) -> Path:
        path = view.file.path.resolve()
        return self._scratch / f"{path.stem}-{_digest(str(path))}"


def _begun(number: int, changes: Mapping[str, Value], before: Params, after: Params) -> Trial:
    named = [TrialChange(name=name, before=before.get(name), value=after.get(name)) for name in sorted(changes)]
    return Trial(
        number=number,
        state="running",
        share=0.0,
        text="getting ready",
        changes=named,
        started=time.time(),
        seconds=0.0,
        stale=False,
    )


def _prepare(home: Path, folder: Path, baseline: Path) -> None:
    """Make the folder of a trial, and remove what is of no use any more: unfinished trials and older replays."""
    try:
        home.mkdir(mode=_MODE, parents=True, exist_ok=True)
        finished = {str(one.number) for one, _ in _records(home)}
        for path in home.iterdir():
            if path.is_dir() and path.name not in finished:
                rmtree(path)
            elif path.is_file() and path.stem != baseline.stem:
                path.unlink(missing_ok=True)
        folder.mkdir(mode=_MODE)
    except OSError as error:
        raise DatabaseError(
            f"{home} can't be written ({error.strerror}): trials need a writable folder, which XDG_CACHE_HOME may name"
        ) from error


def _records(home: Path) -> list[tuple[Trial, str]]:
    """The finished trials in a folder, and the state of the map that each is of."""
    found = []
    for path in home.glob(f"*/{_RECORD}"):
        try:
            record = json.loads(path.read_text("utf-8"))
            found.append((Trial(**record["trial"]), str(record["of"])))
        except (OSError, ValueError, KeyError, TypeError):
            # Of another version: as good as not there, and removed before the next trial.
            continue
    return found


def _aged(trial: Trial, of: str, view: MapView) -> Trial:
    return trial.model_copy(update={"stale": of.partition("-")[0] != _state_of(view.file.path, {}).partition("-")[0]})


def _state_of(path: Path, base: Mapping[str, Value]) -> str:
    """What tells one state of a map file, and of the engine that writes it, from another."""
    logs = (path, path.with_name(f"{path.name}-wal"))
    stats = [log.stat() for log in logs if log.exists()]
    file = _digest(str([(one.st_ino, one.st_size, one.st_mtime_ns) for one in stats]))
    return f"{file}-{_digest(str(sorted(base.items())))}"


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
