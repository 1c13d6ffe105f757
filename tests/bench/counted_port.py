"""A port before a server's port that counts what comes back: the bytes, and the messages of the 3D view's stream."""

from __future__ import annotations

import asyncio
import threading
import time
from contextlib import suppress

_PIECE = 65_536
#: A stream's own sign of life is shorter; a message of a 3D view never is.
_LEAST = 16


class CountedPort:
    """Forwards connections to a port of this machine.

    Attributes:
        port: where to connect.
        bytes: from the server since ``reset``, of all connections.
        views: the same for streams of 3D views alone.
        moments: when something came over a stream of a 3D view, by ``time.monotonic``.
        last: when the last byte came.
    """

    def __init__(self, behind: int) -> None:
        self._behind = behind
        self.bytes = self.views = 0
        self.moments: list[float] = []
        self.last = time.monotonic()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        opened = asyncio.start_server(self._accept, "127.0.0.1", 0)
        self._server = asyncio.run_coroutine_threadsafe(opened, self._loop).result()
        self.port: int = self._server.sockets[0].getsockname()[1]

    def reset(self) -> None:
        """Begin to count anew."""
        self.bytes = self.views = 0
        self.moments = []

    def close(self) -> None:
        """End all connections."""
        asyncio.run_coroutine_threadsafe(self._end(), self._loop).result()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _end(self) -> None:
        self._server.close()
        carrying = asyncio.all_tasks() - {asyncio.current_task()}
        for task in carrying:
            task.cancel()
        await asyncio.gather(*carrying, return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        upstream, up = await asyncio.open_connection("127.0.0.1", self._behind)
        first = await reader.read(_PIECE)
        head = first.lower()
        is_view = b"upgrade: websocket" in head and b" /viser/" in head
        up.write(first)
        with suppress(ConnectionError, asyncio.CancelledError):
            await asyncio.gather(self._carry(reader, up), self._count(upstream, writer, is_view=is_view))

    async def _carry(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while part := await reader.read(_PIECE):
            writer.write(part)
            await writer.drain()
        writer.close()

    async def _count(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, is_view: bool) -> None:
        while part := await reader.read(_PIECE):
            self.last = time.monotonic()
            self.bytes += len(part)
            if is_view:
                self.views += len(part)
                if len(part) > _LEAST:
                    self.moments.append(self.last)
            writer.write(part)
            await writer.drain()
        writer.close()
