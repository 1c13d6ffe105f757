"""The server's end of an engine's process."""

from __future__ import annotations

import asyncio
import itertools
import signal
import threading
from collections.abc import Callable
from typing import Any

from server.engine.commands import Command, Job, Request, RunJob, Stop
from server.engine.events import Answer, Ended, Event, Started
from server.engine.nursery import nursery
from server.engine.process import engine_main
from server.errors import EngineError, EngineGoneError

OnEvent = Callable[[Event], None]

#: Longest time to close a map in order; then the process is ended by force.
STOP_SECONDS = 20.0
#: Longest time to wait for an answer: optimising a very large graph takes many seconds.
_ANSWER_SECONDS = 120.0


class EngineClient:
    """Starts an engine's process, asks it for things and hears what it tells.

    All methods and ``on_event`` belong to one event loop; only the thread that listens to the process does not. Every
    life of a process ends with exactly one ``Ended`` event, also when it was killed.
    """

    def __init__(self, job: Job, on_event: OnEvent) -> None:
        self._job = job
        self._on_event = on_event
        self._loop = asyncio.get_running_loop()
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._started: asyncio.Future[Started] = self._loop.create_future()
        self._last: Ended | None = None
        self._ended = asyncio.Event()
        context = nursery()
        self._connection, theirs = context.Pipe()
        name = "slamdeck-run" if isinstance(job, RunJob) else "slamdeck-edit"
        self._process = context.Process(target=engine_main, args=(theirs, job), name=name, daemon=True)
        self._process.start()
        theirs.close()
        threading.Thread(target=self._listen, name=f"{name}-events", daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Number of the process."""
        return self._process.pid

    @property
    def is_over(self) -> bool:
        """Whether the process has ended, or is about to and takes no more requests."""
        return self._last is not None

    async def started(self) -> Started:
        """Wait until the map is open; raises what refused it."""
        return await asyncio.shield(self._started)

    async def request(self, command: Command) -> Any:
        """Ask for something and wait for the answer.

        Raises:
            EngineGoneError: the process is gone and did nothing of it.
            EngineError: the process died over it.
            SlamError: it refused.
        """
        if self.is_over:
            raise EngineGoneError("the engine has ended: nothing more can be asked of it")
        number = next(self._numbers)
        answer = self._waiting[number] = self._loop.create_future()
        try:
            self._connection.send(Request(number, command))
            return await asyncio.wait_for(answer, _ANSWER_SECONDS)
        except OSError as error:
            raise EngineGoneError("the engine has just ended: nothing more can be asked of it") from error
        except TimeoutError as error:
            raise EngineError(f"the engine did not answer within {_ANSWER_SECONDS:g} s") from error
        finally:
            self._waiting.pop(number, None)

    async def stop(self) -> None:
        """End the process in order: it closes its map. One that does not end in time is killed."""
        if self._ended.is_set():
            return
        try:
            if not self.is_over:
                self._connection.send(Request(0, Stop()))
            await asyncio.wait_for(self._ended.wait(), STOP_SECONDS)
        except (OSError, TimeoutError):
            self._process.kill()
            await self._ended.wait()

    def _listen(self) -> None:
        last: Event | None = None
        try:
            while True:
                last = self._connection.recv()
                self._tell(last)
        except (EOFError, OSError):
            self._process.join()
        if not isinstance(last, Ended):
            self._tell(Ended("failed", EngineError(_death(self._process.exitcode))))
        self._call(self._ended.set)

    def _tell(self, event: Event) -> None:
        self._call(self._take, event)

    def _call(self, function: Callable[..., object], *arguments: object) -> None:
        # After the server's own end nobody is left to be told.
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(function, *arguments)

    def _take(self, event: Event) -> None:
        if isinstance(event, Answer):
            self._settle(event)
            return
        if isinstance(event, Started) and not self._started.done():
            self._started.set_result(event)
        if isinstance(event, Ended):
            self._last = event
            self._give_up(event)
        self._on_event(event)

    def _settle(self, answer: Answer) -> None:
        future = self._waiting.get(answer.number)
        if future is None or future.done():
            return
        if answer.error is not None:
            future.set_exception(answer.error)
        else:
            future.set_result(answer.value)

    def _give_up(self, ended: Ended) -> None:
        error = ended.error or EngineError("the engine ended before it answered")
        if not self._started.done():
            self._started.set_exception(error)
            # Nobody may be waiting for it; then it is no news.
            self._started.exception()
        # One that stops in order has answered everything that it took up.
        kind = EngineGoneError if ended.state != "failed" else EngineError
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(kind(f"the engine ended before it answered ({error})"))


def _death(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"the engine's process was ended by {signal.Signals(-exitcode).name}"
    return f"the engine's process ended by itself with exit code {exitcode}"
