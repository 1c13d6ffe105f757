"""The processes that change maps which are only looked at: one for each, started with its first decision."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from server.catalog import MapFile
from server.engine.client import EngineClient
from server.engine.commands import Command, EditJob
from server.engine.events import Event
from server.errors import EngineGoneError

Listener = Callable[[str, Event], None]


class Editors:
    """Asks the editor of a map for something, and starts it where there is none."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._clients: dict[str, EngineClient] = {}
        self._starting = asyncio.Lock()

    async def request(self, file: MapFile, command: Command) -> Any:
        """Ask for something; raises what refuses it, MapBusyError among others when somebody else writes the map."""
        client = await self._client(file)
        try:
            return await client.request(command)
        except EngineGoneError:
            # It had just closed the map because nobody had asked for long.
            return await (await self._client(file)).request(command)

    async def release(self, file: MapFile) -> None:
        """Let go of a map that somebody else is about to write."""
        async with self._starting:
            client = self._clients.pop(file.id, None)
        if client is not None:
            await client.stop()

    async def close(self) -> None:
        """End all of them: they close their maps."""
        await asyncio.gather(*(client.stop() for client in self._clients.values()))

    async def _client(self, file: MapFile) -> EngineClient:
        async with self._starting:
            client = self._clients.get(file.id)
            if client is None or client.is_over:
                client = EngineClient(EditJob(file.path), lambda event: self._listener(file.id, event))
                self._clients[file.id] = client
                await client.started()
            return client
