"""A window of a 3D view that takes what it is sent and draws nothing."""

from __future__ import annotations

import threading
import time
from importlib.metadata import version

import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from tests.web.served import Served

_NAME = "1-1"
_PATIENCE_S, _QUIET_S = 60.0, 1.5


class DrainedView:
    """A viewer of a map of a server, with the cloud hidden.

    Attributes:
        moments: when a message came, by ``time.monotonic``.
    """

    def __init__(self, server: Served, map_id: str) -> None:
        self.moments: list[float] = []
        token = server.url.split("token=")[1]
        self._http = httpx.Client(headers={"Authorization": f"Bearer {token}"}, timeout=_PATIENCE_S)
        self._scene = f"{server.base}api/scene/{map_id}?viewer={_NAME}"
        self.change(layers={"cloud": False})
        self._stream = connect(
            f"{server.base.replace('http', 'ws', 1)}viser/{map_id}/@{_NAME}/",
            additional_headers={"Authorization": f"Bearer {token}"},
            subprotocols=[Subprotocol(f"viser-v{version('viser')}")],
            max_size=None,
            compression=None,
        )
        self._thread = threading.Thread(target=self._take, args=(self._stream,), daemon=True)
        self._thread.start()

    def change(self, **wanted: object) -> None:
        """Ask for something else to be shown."""
        self._http.patch(self._scene, json=wanted).raise_for_status()

    def quiet(self) -> None:
        """Wait until nothing came for a while; raises TimeoutError."""
        since = time.monotonic()
        while time.monotonic() - max([since, *self.moments[-1:]]) < _QUIET_S:
            if time.monotonic() - since > _PATIENCE_S:
                raise TimeoutError("a 3D view goes on sending")
            time.sleep(0.02)

    def close(self) -> None:
        """End the stream."""
        self._stream.close()
        self._thread.join()
        self._http.close()

    def _take(self, stream: ClientConnection) -> None:
        try:
            for _ in stream:
                self.moments.append(time.monotonic())
        except ConnectionClosed:
            return
