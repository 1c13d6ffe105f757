"""What the server is told once, before it starts."""

from __future__ import annotations

import ipaddress
import os
import secrets
from dataclasses import dataclass, field
from pathlib import Path

from server.errors import SettingsError


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)


def cache_folder() -> Path:
    """Where this user's programs keep what can be made again: ``$XDG_CACHE_HOME`` or ``~/.cache``."""
    named = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(named) if Path(named).is_absolute() else Path.home() / ".cache") / "slamdeck"


@dataclass(frozen=True, slots=True)
class Settings:
    """How to serve, and what.

    Attributes:
        roots: folders with maps, and single map files; new maps go into the first folder.
        sources: folders under which sources of new runs may lie.
        host: address to listen on.
        port: 0 takes a free one.
        token: what lets a browser in; None lets everybody in, on a loopback address only.
        hosts: further names under which the server is reached (behind a reverse proxy).
        scratch: folder for trials of parameters, which stay there until people discard them.
    """

    roots: tuple[Path, ...]
    sources: tuple[Path, ...] = ()
    host: str = "127.0.0.1"
    port: int = 8700
    token: str | None = field(default_factory=new_token)
    hosts: tuple[str, ...] = ()
    scratch: Path = field(default_factory=lambda: cache_folder() / "trials")

    def __post_init__(self) -> None:
        if self.token is None and not is_loopback(self.host):
            raise SettingsError(
                f"refusing to serve on {self.host} without a token: anybody in the network could change the maps; "
                "leave out --no-token, or listen on 127.0.0.1"
            )
        if self.token is not None and len(self.token) < 16:
            raise SettingsError("the token must have at least 16 characters; leave it out to get a random one")
        if not 0 <= self.port <= 65535:
            raise SettingsError(f"port {self.port} does not exist: use 1 to 65535, or 0 for a free one")


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address to listen on."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
