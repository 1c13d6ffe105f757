"""A run over a source, paused, stepped and changed from outside."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping

from server.engine.channel import Channel
from server.engine.commands import (
    CancelJob,
    Decide,
    DropNodes,
    Edit,
    LabelNodes,
    Pause,
    Request,
    Resume,
    RunJob,
    SetParams,
    StartJob,
    Step,
    Stop,
)
from server.engine.decision import carry_out
from server.engine.edits import Edits
from server.engine.events import Ended, GraphChanged, InForce, Moved, NodeAdded, Progress, Started
from server.engine.mapping import engine_on_map, session_params
from server.engine.pace import Pace
from server.errors import EngineError
from slam.accuracy import frames_ate_m
from slam.database import MapReader, MapWriter
from slam.edit.wishes import Outcome
from slam.effect import Effect
from slam.errors import ParameterError, SlamError
from slam.geometry import Pose
from slam.review import Review
from slam.run import Tally, ate_rmse_m, prepared
from slam.sensors import open_source
from slam.slam import Slam
from slam.types import Frame, Update

_PROGRESS_SECONDS = 0.25
_MOVED_SECONDS = 0.1
_ATE_SECONDS = 2.0


class Runner:
    """Maps one source into one file."""

    def __init__(self, job: RunJob, channel: Channel) -> None:
        self._job = job
        self._channel = channel
        self._tally = Tally()
        self._pace = Pace(job.speed)
        self._paused = False
        self._steps = 0
        self._stopping = False
        self._told = self._moved = self._judged = 0.0
        self._ate_m: float | None = None
        self._recent: deque[float] = deque(maxlen=60)

    def run(self) -> Ended:
        """Process frames until the source ends or somebody stops it."""
        job = self._job
        source = open_source(job.source)
        params = session_params(job.path, job.params, append=job.append)
        opening = engine_on_map(
            job.path, params, seed=job.seed, source=source.name, overwrite=job.overwrite, append=job.append
        )
        with opening as (slam, writer):
            if writer is None:
                raise ParameterError("Mem/LocalizationReadOnly=true: decisions need a file that may be written")
            reader = MapReader(job.path)
            self._review = self._make_review(slam, writer, reader)
            self._edits = Edits(self._review, reader)
            self._channel.send(Started(source.name, None if source.live else len(source), dict(params.items())))
            for frame in prepared(source, slam):
                self._attend(slam, frame)
                if self._stopping:
                    break
                self._take_in(slam, slam.process(frame))
            self._ate_m = ate_rmse_m(slam)
            self._progress(slam)
        summary = self._tally.summary(slam, seed=job.seed, path=job.path)
        return Ended("stopped" if self._stopping else "finished", summary=summary)

    def _take_in(self, slam: Slam, update: Update) -> None:
        now = time.monotonic()
        self._tally.add(update)
        self._recent.append(now)
        if now - self._judged > _ATE_SECONDS and update.node is not None:
            self._judged, self._ate_m = now, ate_rmse_m(slam)
        if now - self._moved > _MOVED_SECONDS:
            self._moved = now
            self._channel.send(Moved(update.T_map_base))
        if update.node is not None:
            self._channel.send(_node_added(update))
        # A single step is told at once: nothing follows it that would tell.
        if now - self._told > _PROGRESS_SECONDS or update.node is not None or self._paused:
            self._progress(slam)
        self._steps = max(0, self._steps - 1)

    def _attend(self, slam: Slam, frame: Frame) -> None:
        """Carry out what was asked; wait while paused, and until the frame is due."""
        while not self._stopping:
            waiting = self._paused and not self._steps
            wait = None if waiting else self._pace.wait_for(frame.stamp)
            request = self._channel.next(0 if self._steps else wait)
            if request is not None:
                self._obey(slam, request)
            elif not waiting:
                return

    def _obey(self, slam: Slam, request: Request) -> None:
        command = request.command
        try:
            if isinstance(command, SetParams):
                self._set_params(slam, request, command)
            elif isinstance(command, Decide):
                self._decide(slam, request, command)
            elif isinstance(command, Edit):
                self._edit(slam, request, command)
            elif not isinstance(command, Pause | Resume | Step | Stop):
                raise EngineError(_not_now(command))
            else:
                self._steer(command)
                self._progress(slam)
                self._channel.answer(request)
        except SlamError as error:
            self._channel.refuse(request, error)

    def _steer(self, command: Pause | Resume | Step | Stop) -> None:
        self._pace.restart()
        if isinstance(command, Stop):
            self._stopping = True
        elif isinstance(command, Step):
            self._paused, self._steps = True, 1
        else:
            self._paused, self._steps = isinstance(command, Pause), 0

    def _set_params(self, slam: Slam, request: Request, command: SetParams) -> None:
        if not command.changes:
            raise ParameterError("no parameter is named: give at least one name with its new value")
        in_force = dict(slam.set_params(command.changes).items())
        self._review.params = slam.params
        self._channel.answer(request, in_force)
        self._channel.send(InForce({name: in_force[name] for name in command.changes}))

    def _make_review(self, slam: Slam, writer: MapWriter, reader: MapReader) -> Review:
        graph = slam.graph

        def ate(poses: Mapping[int, Pose]) -> float | None:
            return frames_ate_m(slam.frames, poses, graph.links)

        return Review(graph, writer, reader, slam.params, ate, nodes_stay=True)

    def _decide(self, slam: Slam, request: Request, command: Decide) -> None:
        self._done(slam, request, carry_out(self._review, command), preview=command.preview)

    def _edit(self, slam: Slam, request: Request, command: Edit) -> None:
        """Between two frames all nodes of the graph are in the file, and nothing of the pipeline is under way."""
        if isinstance(command, DropNodes):
            raise EngineError(_not_now(command))
        answer = self._edits.carry_out(command)
        if isinstance(command, LabelNodes) and not command.preview:
            slam.keep(command.node_ids)
        self._done(slam, request, answer, preview=command.preview)

    def _done(self, slam: Slam, request: Request, answer: Outcome | Effect, *, preview: bool) -> None:
        if not preview:
            self._settings_changed(slam)
            slam.poses_changed()
            self._channel.send(GraphChanged())
        self._channel.answer(request, answer)

    def _settings_changed(self, slam: Slam) -> None:
        """Go on with the parameters that a decision changed with the map."""
        before, now = dict(slam.params.items()), dict(self._review.params.items())
        changed = {name: value for name, value in now.items() if value != before[name]}
        if changed:
            slam.params_decided(self._review.params)
            self._channel.send(InForce(changed))

    def _progress(self, slam: Slam) -> None:
        self._told = time.monotonic()
        span = self._recent[-1] - self._recent[0] if len(self._recent) > 1 else 0.0
        fps = (len(self._recent) - 1) / span if span > 0 else 0.0
        self._channel.send(
            Progress(
                state="paused" if self._paused else "running",
                frame=self._tally.frames,
                nodes=len(slam.graph),
                lost=self._tally.lost_frames,
                fps=fps,
                ate_m=self._ate_m,
            )
        )


def _not_now(command: DropNodes | StartJob | CancelJob) -> str:
    if isinstance(command, DropNodes):
        return (
            "nodes can't leave the map while it is made: the engine's memory of places, words and beliefs holds them."
            " Stop the run first; pausing it is not enough"
        )
    return "many loops can't be looked for or refined while the map is made: stop the run first"


def _node_added(update: Update) -> NodeAdded:
    assert update.node is not None
    return NodeAdded(
        node_id=update.node.id,
        frame=update.frame_index,
        stamp=update.stamp,
        statistics=dict(update.statistics),
        candidates=update.candidates,
        tiers=dict(update.tiers),
        optimized=update.optimized,
    )
