"""Weights of loops by GNC, worked out on request in a process of its own: GTSAM holds Python's lock all the while."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from server.browse.map_view import MapView
from server.browse.snapshot import Pair, Snapshot
from server.engine.nursery import nursery
from server.errors import EngineError
from server.hub import Hub
from server.schemas import LoopWeights
from slam.database import MapReader
from slam.errors import SlamError


@dataclass(slots=True, eq=False)
class _Work:
    """One request: since when, of which revision, and what came of it."""

    revision: int
    began: float
    process: BaseProcess | None
    seconds: float = 0.0
    weights: dict[Pair, float] | None = None
    error: SlamError | None = None


class RobustWeights:
    """At most one computation for each map; the last result is kept."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._lock = threading.Lock()
        self._works: dict[str, _Work] = {}

    def start(self, view: MapView) -> LoopWeights:
        """Work them out for the graph as it is in the file; one that is under way goes on."""
        snapshot = view.snapshot()
        with self._lock:
            known = self._works.get(view.file.id)
            if known is None or known.process is None:
                context = nursery()
                ours, theirs = context.Pipe(duplex=False)
                process = context.Process(target=weigh_file, args=(theirs, view.file.path), daemon=True)
                process.start()
                theirs.close()
                work = self._works[view.file.id] = _Work(snapshot.revision, time.monotonic(), process)
                threading.Thread(target=self._wait, args=(view.file.id, work, ours), daemon=True).start()
        return self.state(view)

    def state(self, view: MapView) -> LoopWeights:
        """What is known now."""
        with self._lock:
            work = self._works.get(view.file.id)
        if work is None:
            return LoopWeights(state="none", message="", seconds=0.0, stale=False, weights={})
        if work.process is not None:
            return LoopWeights(
                state="running", message="", seconds=time.monotonic() - work.began, stale=False, weights={}
            )
        return LoopWeights(
            state="failed" if work.error is not None else "done",
            message="" if work.error is None else str(work.error),
            seconds=work.seconds,
            stale=work.revision != view.snapshot().revision,
            weights={f"{a}-{b}": weight for (a, b), weight in (work.weights or {}).items()},
        )

    def close(self) -> None:
        """Give up what is under way."""
        with self._lock:
            for work in self._works.values():
                if work.process is not None:
                    work.process.kill()

    def _wait(self, map_id: str, work: _Work, answers: Connection[Any, Any]) -> None:
        try:
            answer = answers.recv()
        except EOFError:
            answer = EngineError("the process that weighed the loops has ended before it was done")
        with self._lock:
            work.process, work.seconds = None, time.monotonic() - work.began
            if isinstance(answer, SlamError):
                work.error = answer
            else:
                work.weights = answer
        self._hub.publish("weights", map_id, {"done": True})


def weigh_file(answers: Connection[Any, Any], path: Path) -> None:
    """Answer with the weight of each loop of a map file by its pair, or with what refuses it."""
    from slam.graph.robust_weights import loop_weights

    try:
        snapshot = Snapshot(MapReader(path), 1, {})
        answers.send(loop_weights(snapshot.graph, snapshot.params))
    except SlamError as error:
        answers.send(error)
