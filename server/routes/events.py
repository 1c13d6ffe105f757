"""The stream of changes."""

from __future__ import annotations

import asyncio
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from server.hub import Mailbox
from server.routes.access import ServicesDep

router = APIRouter(tags=["events"])


@router.websocket("/api/events")
async def stream_events(socket: WebSocket, services: ServicesDep) -> None:
    """Sends the last value of each key, then every change as ``{topic, map, value}``."""
    await socket.accept()
    with services.hub.mailbox() as box:
        sending = asyncio.create_task(_send(socket, box))
        try:
            with suppress(WebSocketDisconnect):
                while True:
                    await socket.receive_text()
        finally:
            sending.cancel()


async def _send(socket: WebSocket, box: Mailbox) -> None:
    # A browser that went away is noticed by the receiving side.
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await socket.send_text(await box.take())
