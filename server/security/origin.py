"""Which addresses the server answers under, and from which pages it takes orders."""

from __future__ import annotations

import ipaddress
import socket
from urllib.parse import urlsplit

from starlette.requests import HTTPConnection

from server.settings import Settings, is_loopback

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class HostCheck:
    """Answers only under its own names, so that no other name that leads here (DNS rebinding) becomes its origin."""

    def __init__(self, settings: Settings) -> None:
        names = {"localhost", settings.host, *settings.hosts}
        self._names = {name.lower().strip("[]") for name in names}
        # An address made of digits can't be rebound; which ones lead here is the network's business.
        self._any_address = not is_loopback(settings.host)
        if self._any_address:
            self._names |= {socket.gethostname().lower(), socket.getfqdn().lower()}

    def knows(self, connection: HTTPConnection) -> bool:
        """Whether the request's one Host header is one of ours."""
        given = connection.headers.getlist("host")
        name = host_name(given[0]) if len(given) == 1 else ""
        if name in self._names:
            return True
        try:
            address = ipaddress.ip_address(name)
        except ValueError:
            return False
        return self._any_address or address.is_loopback


def host_name(host: str) -> str:
    """The name in ``name:port``, lower case, without the brackets of an IPv6 address; empty when it makes no sense."""
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""


def comes_from_own_page(connection: HTTPConnection) -> bool:
    """Whether a request that changes something, or opens a stream, comes from our page or from no page at all.

    Browsers say where a request comes from (``Origin``, ``Sec-Fetch-Site``) and no page can make them lie; programs
    that are no browsers say nothing, and carry no cookie that somebody could abuse.
    """
    if connection.scope["type"] == "http" and connection.scope["method"] in _SAFE_METHODS:
        return True
    origins = connection.headers.getlist("origin")
    if origins:
        host = connection.headers.get("host", "").lower()
        return all(urlsplit(origin).netloc.lower() == host for origin in origins)
    return connection.headers.get("sec-fetch-site", "none") in ("same-origin", "none")
