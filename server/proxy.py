"""The way from a browser to a map's 3D view: one port and one token cover everything."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import Any

import httpx
from fastapi import APIRouter, Request, Response, WebSocket, WebSocketDisconnect
from fastapi.responses import RedirectResponse
from starlette.concurrency import run_in_threadpool
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from server.errors import EngineError
from server.routes.access import MapId, ServicesDep
from slam.errors import SlamError

router = APIRouter(include_in_schema=False)

#: Headers that belong to one leg of the way.
_HOP = frozenset({"connection", "keep-alive", "transfer-encoding", "upgrade", "content-length", "host", "cookie"})
_GOING_AWAY = 1001
_BAD_GATEWAY = 1014
_NO_STATUS = 1005


@router.get("/viser/{map}")
def add_slash(map_id: MapId) -> Response:
    """The view finds its stream relative to its address, which must end in a slash."""
    return RedirectResponse(f"/viser/{map_id}/")


@router.get("/viser/{map}/{path:path}")
@router.get("/viser/{map}/@{viewer}/{path:path}")
async def forward(request: Request, services: ServicesDep, map_id: MapId, path: str, viewer: str = "") -> Response:
    """A file of viser's client."""
    port = await run_in_threadpool(lambda: services.scenes.shown(services.view(map_id), viewer).port)
    headers = {name: value for name, value in request.headers.items() if name.lower() in ("accept", "accept-encoding")}
    try:
        async with (
            httpx.AsyncClient() as client,
            client.stream("GET", _url("http", port, path), headers=headers) as got,
        ):
            # The bytes as they come, compressed: unpacking them here only to pack them again helps nobody.
            body = b"".join([chunk async for chunk in got.aiter_raw()])
    except httpx.HTTPError as error:
        raise EngineError(f"the 3D view of {map_id} does not answer ({error}); reload the page") from error
    kept = {name: value for name, value in got.headers.items() if name.lower() not in _HOP}
    return Response(body, got.status_code, headers={**kept, "Cache-Control": "no-cache"})


@router.websocket("/viser/{map}/@{viewer}/")
@router.websocket("/viser/{map}/@{viewer}")
@router.websocket("/viser/{map}/")
@router.websocket("/viser/{map}")
async def forward_stream(socket: WebSocket, services: ServicesDep, map_id: MapId, viewer: str = "") -> None:
    """The stream between viser's client and its server, message by message."""
    try:
        port = await run_in_threadpool(lambda: services.scenes.shown(services.view(map_id), viewer).port)
    except SlamError:
        await socket.close(_GOING_AWAY)
        return
    asked = [Subprotocol(text) for text in socket.scope.get("subprotocols", [])]
    try:
        async with connect(
            _url("ws", port, ""), subprotocols=asked or None, max_size=None, compression=None, proxy=None
        ) as upstream:
            await socket.accept(subprotocol=upstream.subprotocol)
            await _relay(socket, upstream)
    except (OSError, WebSocketException):
        with suppress(RuntimeError):
            await socket.close(_BAD_GATEWAY)


async def _relay(socket: WebSocket, upstream: ClientConnection) -> None:
    """Carry messages both ways until one side ends; then end the other with the same code."""
    tasks = [asyncio.create_task(_up(socket, upstream)), asyncio.create_task(_down(socket, upstream))]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _up(socket: WebSocket, upstream: ClientConnection) -> None:
    with suppress(ConnectionClosed):
        while True:
            message: dict[str, Any] = dict(await socket.receive())
            if message["type"] == "websocket.disconnect":
                return
            data = message.get("bytes")
            await upstream.send(message["text"] if data is None else data)


async def _down(socket: WebSocket, upstream: ClientConnection) -> None:
    with suppress(WebSocketDisconnect, RuntimeError):
        with suppress(ConnectionClosed):
            while True:
                message = await upstream.recv()
                if isinstance(message, bytes):
                    await socket.send_bytes(message)
                else:
                    await socket.send_text(message)
        code = upstream.close_code or _GOING_AWAY
        await socket.close(_GOING_AWAY if code == _NO_STATUS else code, upstream.close_reason or "")


def _url(scheme: str, port: int, path: str) -> str:
    return f"{scheme}://127.0.0.1:{port}/{path}"
