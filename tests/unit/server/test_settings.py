"""Settings that are not safe are refused."""

from __future__ import annotations

import errno
import socket
from pathlib import Path

import pytest

from server.errors import SettingsError
from server.serving import bind, link
from server.settings import Settings, is_loopback, new_token

ROOTS = (Path(),)


def test_a_token_is_made_and_is_another_each_time() -> None:
    tokens = {Settings(ROOTS).token for _ in range(3)}
    assert len(tokens) == 3 and all(token is not None and len(token) >= 32 for token in tokens)


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org"])
def test_without_a_token_only_this_machine_is_served(host: str) -> None:
    with pytest.raises(SettingsError, match="token"):
        Settings(ROOTS, host=host, token=None)
    Settings(ROOTS, host=host, token=new_token())


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1", "127.8.9.10"])
def test_loopback_addresses(host: str) -> None:
    assert is_loopback(host)
    Settings(ROOTS, host=host, token=None)


def test_a_guessable_token_is_refused() -> None:
    with pytest.raises(SettingsError, match="16"):
        Settings(ROOTS, token="secret")


def test_a_taken_port_is_named_with_what_to_do() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(SettingsError, match=rf"{port} is in use.*--port"):
            bind(Settings(ROOTS, port=port))


def test_an_address_that_is_not_ours_is_named() -> None:
    with pytest.raises(SettingsError, match=r"203\.0\.113\.7.*--host"):
        bind(Settings(ROOTS, host="203.0.113.7", port=0))
    assert errno.EADDRNOTAVAIL


@pytest.mark.parametrize(("host", "shown"), [("127.0.0.1", "127.0.0.1"), ("0.0.0.0", "127.0.0.1"), ("::1", "[::1]")])
def test_the_link_opens_the_page(host: str, shown: str) -> None:
    settings = Settings(ROOTS, host=host, port=0)
    with bind(settings) as listening:
        assert link(settings, listening) == f"http://{shown}:{listening.getsockname()[1]}/?token={settings.token}"
