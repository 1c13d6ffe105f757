"""The token that lets a browser in."""

from __future__ import annotations

import hmac
from http.cookies import CookieError, SimpleCookie

from starlette.requests import HTTPConnection


class TokenCheck:
    """Compares what a request carries with the token, in constant time; without a token everybody is let in."""

    def __init__(self, token: str | None) -> None:
        self._token = token

    def is_right(self, text: str) -> bool:
        """Whether a text is the token."""
        return self._token is None or hmac.compare_digest(text.encode(), self._token.encode())

    def lets_in(self, connection: HTTPConnection) -> bool:
        """Whether a request has the cookie or the ``Authorization: Bearer`` header."""
        if self._token is None:
            return True
        scheme, _, text = connection.headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer" and self.is_right(text.strip()):
            return True
        return self.is_right(_cookie(connection))

    def cookie_header(self, connection: HTTPConnection) -> str:
        """The ``Set-Cookie`` header that a browser gets for the right token."""
        secure = "; Secure" if connection.url.scheme == "https" else ""
        return f"{cookie_name(connection)}={self._token or ''}; HttpOnly; SameSite=Strict; Path=/{secure}"


def cookie_name(connection: HTTPConnection) -> str:
    """Name of the cookie: browsers share cookies between the ports of a host, several servers must not."""
    server = connection.scope.get("server") or ("", 0)
    return f"slamdeck-{server[1]}"


def _cookie(connection: HTTPConnection) -> str:
    try:
        found = SimpleCookie(connection.headers.get("cookie", "")).get(cookie_name(connection))
    except CookieError:
        return ""
    return "" if found is None else found.value
