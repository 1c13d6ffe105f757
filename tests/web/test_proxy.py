"""The way to a map's 3D view: HTTP and WebSocket, messages of any size, whole and in order."""

from __future__ import annotations

import gzip
import os
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import Any

import pytest
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve
from websockets.typing import Subprotocol

from server.settings import Settings
from tests.unit.server.loop_map import write_loop_map
from tests.unit.server.running import TOKEN, RunningApp

PAGE = b"<html>the view</html>" * 50
BIG = os.urandom(6_000_000)


@dataclass
class Upstream:
    """A server that stands for viser's: it echoes, and says something big when asked."""

    server: Server
    port: int


@pytest.fixture
def upstream() -> Iterator[Upstream]:
    def page(_: ServerConnection, request: Request) -> Response | None:
        if request.headers.get("Upgrade") == "websocket":
            return None
        if request.path != "/":
            return Response(404, "Not Found", Headers(), b"none")
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            body, coding = gzip.compress(PAGE), "gzip"
        else:
            body, coding = PAGE, "identity"
        headers = Headers({"Content-Type": "text/html", "Content-Encoding": coding, "Content-Length": str(len(body))})
        return Response(HTTPStatus.OK, "OK", headers, body)

    def talk(connection: ServerConnection) -> None:
        try:
            for message in connection:
                if message == "bye":
                    connection.close(4321, "as asked")
                    return
                connection.send(BIG if message == "big" else message)
        except ConnectionClosed:
            return

    def choose(_: ServerConnection, offered: Any) -> Subprotocol | None:
        return next((p for p in offered if p.startswith("viser-v")), None)

    server = serve(
        talk, "127.0.0.1", 0, process_request=page, select_subprotocol=choose, compression=None, max_size=None
    )
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield Upstream(server, server.socket.getsockname()[1])
    server.shutdown()
    thread.join(10)


@pytest.fixture
def app(tmp_path: Path, upstream: Upstream, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunningApp]:
    """The app with that server in the place of the map's 3D view."""
    write_loop_map(tmp_path / "loops.db")
    with RunningApp(Settings(roots=(tmp_path,), token=TOKEN, port=0), None) as app:
        monkeypatch.setattr(app.services.scenes, "shown", lambda *_: upstream)
        yield app


@pytest.mark.parametrize("accepted", ["gzip", "identity"])
def test_the_page_comes_as_it_is_with_a_policy_of_its_own(app: RunningApp, accepted: str) -> None:
    answer = app.get("/viser/loops/", headers={"Accept-Encoding": accepted})
    assert answer.content == PAGE and answer.headers["content-encoding"] == accepted
    policy = answer.headers["content-security-policy"]
    assert "'wasm-unsafe-eval'" in policy and "default-src 'none'" in policy and "frame-ancestors 'self'" in policy
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_other_paths_and_maps(app: RunningApp) -> None:
    assert app.get("/viser/loops/none").status_code == 404
    assert app.get("/viser/none/").status_code == 404
    assert app.get("/viser/loops/%4012-3/").content == app.get("/viser/loops/@12-3/").content == PAGE
    answer = app.get("/viser/loops")
    assert answer.status_code == 307 and answer.headers["location"] == "/viser/loops/"


def test_messages_pass_both_ways_whole_and_in_order(app: RunningApp) -> None:
    with app.stream_of("/viser/loops/", subprotocols=["viser-v1.2.3"], max_size=None) as stream:
        assert stream.subprotocol == "viser-v1.2.3"
        for k in range(200):
            stream.send(bytes([k]) if k % 2 else f"text {k}")
        assert [stream.recv(timeout=20) for _ in range(200)] == [
            bytes([k]) if k % 2 else f"text {k}" for k in range(200)
        ]
        stream.send("big")
        assert stream.recv(timeout=60) == BIG


def test_an_end_on_either_side_ends_the_other(app: RunningApp) -> None:
    with app.stream_of("/viser/loops/", subprotocols=["viser-v1"]) as stream:
        stream.send("bye")
        with pytest.raises(ConnectionClosed) as ended:
            stream.recv(timeout=20)
    assert ended.value.rcvd is not None
    assert (ended.value.rcvd.code, ended.value.rcvd.reason) == (4321, "as asked")
    with app.stream_of("/viser/loops/", subprotocols=["viser-v1"]) as stream:
        stream.send("hello")
        assert stream.recv(timeout=20) == "hello"


def test_no_view_no_stream(app: RunningApp) -> None:
    with pytest.raises((InvalidStatus, ConnectionClosed)), app.stream_of("/viser/none/") as stream:
        stream.recv(timeout=20)


def test_a_view_that_is_gone_is_said(app: RunningApp, upstream: Upstream) -> None:
    upstream.server.shutdown()
    upstream.server.socket.close()
    answer = app.get("/viser/loops/")
    assert answer.status_code == 409 and "reload" in answer.json()["error"]["message"]
    with pytest.raises((InvalidStatus, ConnectionClosed)), app.stream_of("/viser/loops/") as stream:
        stream.recv(timeout=20)
