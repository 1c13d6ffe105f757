"""The app on a real socket, in a thread of the test."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

import httpx
import uvicorn
from websockets.sync.client import ClientConnection, connect

from server.app import create_app
from server.services import Services
from server.serving import Serving, bind
from server.settings import Settings

TOKEN = "a-token-for-the-tests"


class RunningApp(httpx.Client):
    """A client of the app; it has the token unless it is not to be authorized."""

    def __init__(self, settings: Settings, page: Path | None, *, authorized: bool = True) -> None:
        app = create_app(settings, page)
        self.services: Services = app.state.services
        listening = bind(settings)
        self.port: int = listening.getsockname()[1]
        ready = threading.Event()
        config = uvicorn.Config(app, log_level="warning", lifespan="on", timeout_graceful_shutdown=1)
        self._server = Serving(config, ready.set)
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [listening]}, daemon=True)
        self._thread.start()
        if not ready.wait(30):
            raise AssertionError("the app did not start")
        self.authorization = {"Authorization": f"Bearer {TOKEN}"} if authorized else {}
        super().__init__(base_url=f"http://127.0.0.1:{self.port}", headers=self.authorization, timeout=60)

    def stream_of(self, path: str, **options: Any) -> ClientConnection:
        """A WebSocket to the app."""
        headers = {**self.authorization, **options.pop("headers", {})}
        return connect(f"ws://127.0.0.1:{self.port}{path}", additional_headers=headers, proxy=None, **options)

    def __exit__(
        self,
        exc_type: type[BaseException] | None = None,
        exc_value: BaseException | None = None,
        traceback: TracebackType | None = None,
    ) -> None:
        """End the app in order."""
        super().__exit__(exc_type, exc_value, traceback)
        self._server.should_exit = True
        self._thread.join(30)


StartApp = Callable[..., RunningApp]
