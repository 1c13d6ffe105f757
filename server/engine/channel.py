"""The engine's end of the channel."""

from __future__ import annotations

import queue
import threading
from contextlib import suppress
from multiprocessing.connection import Connection

from server.engine.commands import Request, Stop
from server.engine.events import Answer, Event
from slam.errors import SlamError

#: Seconds; Python 3.11.2 waits for ever when it is asked to wait for less than a microsecond.
_NO_TIME = 1e-3


class Channel:
    """Takes requests from the server and sends events to it.

    A thread of its own listens, so that the server never waits to hand over a request, and a server that died is
    noticed at once: its last request is then to stop.
    """

    def __init__(self, connection: Connection[Event, Request]) -> None:
        self._connection = connection
        self._requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
        threading.Thread(target=self._listen, name="requests", daemon=True).start()

    def send(self, event: Event) -> None:
        """Tell the server; when it is gone, nobody is told."""
        with suppress(OSError):
            self._connection.send(event)

    def answer(self, request: Request, value: object = None) -> None:
        """Answer a request."""
        self.send(Answer(request.number, value))

    def refuse(self, request: Request, error: SlamError) -> None:
        """Answer a request that can't be carried out."""
        self.send(Answer(request.number, error=error))

    def next(self, timeout: float | None) -> Request | None:
        """The next request; None when there is none within ``timeout`` seconds (None waits for ever)."""
        with suppress(queue.Empty):
            if timeout is not None and timeout < _NO_TIME:
                return self._requests.get_nowait()
            return self._requests.get(timeout=timeout)
        return None

    def request_stop(self) -> None:
        """Put in a request to stop that nobody waits for."""
        self._requests.put(Request(0, Stop()))

    def _listen(self) -> None:
        with suppress(EOFError, OSError):
            while True:
                self._requests.put(self._connection.recv())
        self.request_stop()
