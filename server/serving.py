"""Serving until somebody says stop."""

from __future__ import annotations

import errno
import gc
import signal
import socket
import threading
from collections.abc import Callable
from importlib import import_module

import uvicorn
from starlette.types import ASGIApp

from server.errors import SettingsError
from server.settings import Settings

#: Longest time for open requests and streams to end.
_GRACE_SECONDS = 2
_WILDCARDS = {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}


class Serving(uvicorn.Server):
    """uvicorn, which also says when it is ready, and works ahead then."""

    def __init__(
        self, config: uvicorn.Config, on_ready: Callable[[], None], ahead: Callable[[], None] = lambda: None
    ) -> None:
        super().__init__(config)
        self._on_ready = on_ready
        self._ahead = ahead

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to listen, then call ``on_ready``."""
        await super().startup(sockets)
        if self.started:
            self._on_ready()
            threading.Thread(target=self._work_ahead, name="work ahead", daemon=True).start()

    def _work_ahead(self) -> None:
        """Do what the page asks first while the browser is still on its way: read a map, load the 3D view."""
        # What is loaded by now stays to the end: no collection has to walk through it each time a large map is read.
        gc.freeze()
        self._ahead()
        import_module("server.scene.painter")


def bind(settings: Settings) -> socket.socket:
    """A socket on the address of the settings.

    Raises:
        SettingsError: the address is taken or not ours; says what to do.
    """
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((settings.host, settings.port))
        listening.listen(128)
    except OSError as error:
        listening.close()
        raise SettingsError(_why(settings, error)) from error
    return listening


def serve(
    app: ASGIApp, listening: socket.socket, on_ready: Callable[[], None], ahead: Callable[[], None] = lambda: None
) -> None:
    """Serve until SIGINT or SIGTERM; maps that are open are closed before this returns.

    ``ahead`` is done in a thread once it serves, before anybody asks for it.
    """
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=_GRACE_SECONDS,
        lifespan="on",
        server_header=False,
    )
    # uvicorn stops in order, then raises the signal again for those who were there before it: that is this, which says
    # that all is done.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: None)
    Serving(config, on_ready, ahead).run(sockets=[listening])


def link(settings: Settings, listening: socket.socket) -> str:
    """The address that opens the page, token included."""
    host = _WILDCARDS.get(settings.host, settings.host)
    name = f"[{host}]" if ":" in host else host
    query = "" if settings.token is None else f"?token={settings.token}"
    return f"http://{name}:{listening.getsockname()[1]}/{query}"


def _why(settings: Settings, error: OSError) -> str:
    where = f"{settings.host} port {settings.port}"
    if error.errno == errno.EADDRINUSE:
        return f"{where} is in use by another program: stop that one, or name another port with --port (0: a free one)"
    if error.errno == errno.EACCES:
        return f"{where} is not open to this user: choose a port from 1024 on with --port"
    return f"can't listen on {where} ({error.strerror}): use an address of this machine with --host"
