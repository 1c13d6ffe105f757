"""A map that is only looked at, open for writing as long as people decide about it."""

from __future__ import annotations

from pathlib import Path

from server.browse.snapshot import Snapshot
from server.engine.channel import Channel
from server.engine.commands import Decide, EditJob, Request, Stop
from server.engine.decision import carry_out
from server.engine.events import Ended, GraphChanged, Started
from server.errors import EngineError
from slam.database import MapReader, MapWriter
from slam.errors import SlamError
from slam.graph.graph import PoseGraph
from slam.maps.grid_rebuild import GridRebuild
from slam.review import Review

#: Without a decision for this long the map is closed, and free for other writers.
_IDLE_SECONDS = 30.0
#: Decisions that follow each other faster than this share one new grid.
_REST_SECONDS = 0.5


class Editor:
    """Carries out decisions on one existing map."""

    def __init__(self, job: EditJob, channel: Channel) -> None:
        self._path: Path = job.path
        self._channel = channel

    def run(self) -> Ended:
        """Decide until nobody asks any more."""
        with MapWriter.open(self._path) as writer:
            reader = MapReader(self._path)
            snapshot = Snapshot(reader, 1, {})
            graph = PoseGraph.from_reader(reader)
            review = Review(graph, writer, reader, snapshot.params, lambda poses: snapshot.ate_at(poses, graph.links))
            grid = GridRebuild(reader, writer, graph, snapshot.params)
            self._channel.send(Started("", None, dict(snapshot.params.items())))
            self._serve(review, grid)
        return Ended("stopped")

    def _serve(self, review: Review, grid: GridRebuild) -> None:
        while True:
            request = self._channel.next(_REST_SECONDS if grid.is_due else _IDLE_SECONDS)
            if grid.is_due and (request is None or isinstance(request.command, Stop)):
                grid.carry_out()
                self._channel.send(GraphChanged())
            elif request is None:
                return
            if request is not None and isinstance(request.command, Stop):
                return
            if request is not None:
                self._decide(review, grid, request)

    def _decide(self, review: Review, grid: GridRebuild, request: Request) -> None:
        try:
            if not isinstance(request.command, Decide):
                raise EngineError(f"no engine is mapping {self._path.name}: start a run first")
            effect = carry_out(review, request.command)
        except SlamError as error:
            self._channel.refuse(request, error)
            return
        self._channel.answer(request, effect)
        if not effect.preview:
            grid.is_due = True
            self._channel.send(GraphChanged())
