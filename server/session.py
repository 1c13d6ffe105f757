"""The run: at most one at a time, what is known of it, and what may be asked of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from server.browse.columns import number
from server.engine.client import EngineClient
from server.engine.commands import Command, Pause, Resume, RunJob, SetParams, Step, Stop
from server.engine.events import Ended, Event, InForce, Progress, Started
from server.errors import EngineError
from server.hub import Hub
from server.schemas import Session, SessionCommand
from slam.params import Value

_COMMANDS: Mapping[str, Command] = {"pause": Pause(), "resume": Resume(), "step": Step(), "stop": Stop()}
_ACTIVE = ("starting", "running", "paused")
#: The engine compiles its inner loops when it first runs on a machine.
_PREPARING = "getting ready; the first run on a machine takes some seconds more"
_IDLE = Session(
    map=None, state="idle", frame=0, frames=None, nodes=0, fps=0, ate_m=None, lost=0, message="", source=None, speed=0
)
#: Map id and event, for whoever else follows the run.
Listener = Callable[[str, Event], None]


class RunSession:
    """Starts a run, follows it and steers it; lives in the server's event loop.

    Attributes:
        state: what the page is told.
        summary: of the last run that ended in order.
    """

    def __init__(self, hub: Hub, listener: Listener) -> None:
        self.state = _IDLE
        self.summary: Mapping[str, Any] | None = None
        self._hub = hub
        self._listener = listener
        self._client: EngineClient | None = None
        self._in_force: dict[str, Value] = {}
        self._map_id = ""
        self._on_event: Callable[[Event], None] | None = None

    @property
    def is_active(self) -> bool:
        """Whether a run is under way."""
        return self.state.state in _ACTIVE

    @property
    def live_map(self) -> str | None:
        """Id of the map that is being made now."""
        return self.state.map if self.is_active else None

    @property
    def pid(self) -> int | None:
        """Number of the engine's process."""
        return None if self._client is None else self._client.pid

    async def start(self, map_id: str, job: RunJob, on_event: Callable[[Event], None] | None = None) -> Session:
        """Start a run and wait until its map is open; ``on_event`` hears of everything that the engine tells.

        Raises:
            EngineError: another one is under way.
            SlamError: the source, a parameter or the file is refused.
        """
        if self.is_active:
            raise EngineError(f"a run is under way on map {self.state.map}: stop it before another is started")
        self._map_id, self.summary = map_id, None
        self._publish(_IDLE.model_copy(update={"state": "starting", "source": job.source, "speed": job.speed}))
        self._hub.publish("engine", None, {"error": None})
        self._on_event = on_event
        self._client = EngineClient(job, self._take)
        await self._client.started()
        return self.state

    async def command(self, command: SessionCommand) -> Session:
        """Pause, resume, step or stop; returns when the engine has done it (stop: when the map is closed)."""
        client = self._running()
        await client.request(_COMMANDS[command])
        if command == "stop":
            await client.stop()
        return self.state

    async def request(self, map_id: str, command: Command) -> Any:
        """Ask the engine that makes this map for something; EngineError when there is none."""
        if self.live_map != map_id:
            raise EngineError(f"no engine is mapping {map_id} now: start a run first")
        return await self._running().request(command)

    async def set_parameters(self, map_id: str, changes: Mapping[str, Value]) -> Mapping[str, Value]:
        """Change parameters of the run; all values as the engine has them then."""
        in_force: dict[str, Value] = await self.request(map_id, SetParams(changes))
        self._in_force = in_force
        return in_force

    def parameters_of(self, map_id: str) -> Mapping[str, Value] | None:
        """Values in force in the engine that makes this map; None when none does."""
        return self._in_force if self.live_map == map_id else None

    async def close(self) -> None:
        """End the run in order."""
        if self._client is not None:
            await self._client.stop()

    def _running(self) -> EngineClient:
        if self._client is None or not self.is_active:
            raise EngineError("no run is under way: start one first")
        return self._client

    def _take(self, event: Event) -> None:
        if isinstance(event, Started):
            self._in_force = dict(event.params)
            opened = {"map": self._map_id, "frames": event.frames, "source": event.source}
            self._publish(self._changed(message=_PREPARING, **opened))
        elif isinstance(event, Progress):
            self._publish(self._progressed(event))
        elif isinstance(event, InForce):
            self._in_force.update(event.values)
            self._hub.publish("parameters", self._map_id, dict(event.values))
        elif isinstance(event, Ended):
            self._end(event)
        self._listener(self._map_id, event)
        if self._on_event is not None:
            self._on_event(event)

    def _progressed(self, event: Progress) -> Session:
        return self._changed(
            state=event.state,
            frame=event.frame,
            nodes=event.nodes,
            lost=event.lost,
            fps=round(event.fps, 1),
            ate_m=number(event.ate_m),
            message="",
        )

    def _end(self, event: Ended) -> None:
        self.summary = event.summary
        message = "" if event.error is None else str(event.error)
        self._publish(self._changed(state=event.state, message=message))
        if event.error is not None:
            self._hub.publish("engine", self.state.map, {"error": message})

    def _changed(self, **changes: object) -> Session:
        return self.state.model_copy(update=changes)

    def _publish(self, state: Session) -> None:
        self.state = state
        self._hub.publish("session", state.map, state.model_dump())
