"""The gate that every request goes through, HTTP and WebSocket alike."""

from __future__ import annotations

from pathlib import Path

from starlette.datastructures import URL, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.error_responses import error_response
from server.schemas import ErrorDetail
from server.security.origin import HostCheck, comes_from_own_page
from server.security.policy import frame_headers, page_headers, viser_headers
from server.security.token import TokenCheck
from server.settings import Settings

#: Answers without a token, and says nothing but that it is there (for container health checks).
HEALTH = "/healthz"
#: The document around a 3D view.
_FRAME = "/frame.html"
_POLICY_VIOLATION = 1008
_NO_TOKEN = (
    "this needs the server's token: open the address that its terminal printed, "
    "or send the token as `Authorization: Bearer TOKEN`"
)


class Guard:
    """Checks name, origin and token of every request, and puts the security headers on every response."""

    def __init__(self, app: ASGIApp, settings: Settings, index: Path | None) -> None:
        self._app = app
        self._token = TokenCheck(settings.token)
        self._hosts = HostCheck(settings)
        self._page = page_headers(index)
        self._viser = viser_headers()
        self._frame = frame_headers()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let it through, or answer it here."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        answer = self._stop(connection)
        if answer is None:
            await self._app(scope, receive, self._with_headers(scope, send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": _POLICY_VIOLATION, "reason": ""})
        else:
            await answer(scope, receive, self._with_headers(scope, send))

    def _stop(self, connection: HTTPConnection) -> Response | None:
        """The answer to a request that goes no further."""
        if not self._hosts.knows(connection):
            host = connection.headers.get("host", "")
            return _refusal("wrong_host", f"this server does not answer to the name {host!r}", 421)
        if not comes_from_own_page(connection):
            return _refusal("wrong_origin", "another site asked for this; only the server's own page may", 403)
        path = connection.url.path
        if path == HEALTH:
            return Response("ok\n", media_type="text/plain")
        if path == "/" and "token" in connection.query_params and connection.scope["type"] == "http":
            return self._login(connection)
        if self._token.lets_in(connection):
            return None
        if path.startswith(("/api", "/viser", "/openapi")):
            return _refusal("no_token", _NO_TOKEN, 401)
        return _no_token_page()

    def _login(self, connection: HTTPConnection) -> Response:
        """Turn the token of the link into a cookie, and the address into one that may be seen and copied."""
        if not self._token.is_right(connection.query_params["token"]):
            return _no_token_page()
        clean = connection.url.remove_query_params("token")
        answer = RedirectResponse(_local(clean), status_code=303)
        answer.raw_headers.append((b"set-cookie", self._token.cookie_header(connection).encode("latin-1")))
        return answer

    def _with_headers(self, scope: Scope, send: Send) -> Send:
        path = scope["path"]
        headers = self._viser if path.startswith("/viser/") else self._frame if path == _FRAME else self._page

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(headers)
            await send(message)

        return sending


def _local(url: URL) -> str:
    return f"{url.path}?{url.query}" if url.query else url.path


def _refusal(code: str, message: str, status: int) -> Response:
    return error_response(ErrorDetail(code=code, message=message, status=status))


def _no_token_page() -> Response:
    text = (
        "<!doctype html><meta charset=utf-8><title>slamdeck</title><h1>slamdeck</h1>"
        "<p>This browser has no token for this server yet. Open the address that the server's terminal printed: "
        "it ends in <code>?token=…</code></p>"
    )
    return HTMLResponse(text, status_code=401)
