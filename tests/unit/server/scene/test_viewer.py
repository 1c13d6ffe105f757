"""The viser server is for this machine only and keeps silent."""

from __future__ import annotations

import socket
from typing import Any

import pytest

from server.scene.viewer import Viewer


def test_it_is_reached_on_the_loopback_interface_only(viewer: Any) -> None:
    assert viewer.get_host() == "127.0.0.1"
    with socket.create_connection(("127.0.0.1", viewer.get_port()), timeout=5):
        pass
    with pytest.raises(OSError), socket.create_connection(("127.0.0.2", viewer.get_port()), timeout=5):
        pass


def test_no_client_can_open_a_tunnel_to_the_outside(viewer: Any) -> None:
    assert viewer.request_share_url() is None
    assert viewer._share_tunnel is None


def test_it_says_nothing_on_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    Viewer().stop()
    assert capsys.readouterr().out == ""
