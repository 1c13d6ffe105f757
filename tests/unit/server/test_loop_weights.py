"""Loops are weighed by GNC on request, in the background; the result says when the map has changed since."""

from __future__ import annotations

import time
from typing import Any

from tests.unit.server.running import RunningApp

URL = "/api/maps/loops/loop-weights"


def done(client: RunningApp) -> dict[str, Any]:
    end = time.monotonic() + 60
    while (found := client.get(URL).json())["state"] == "running":
        assert time.monotonic() < end
        time.sleep(0.05)
    return dict(found)


def test_weights_come_on_request_and_grow_stale(client: RunningApp) -> None:
    assert client.get(URL).json()["state"] == "none"
    with client.stream_of("/api/events") as stream:
        assert client.post(URL).json()["state"] in ("running", "done")
        while '"topic":"weights"' not in stream.recv(timeout=60):
            pass
    found = done(client)
    assert found["state"] == "done" and not found["stale"] and found["seconds"] > 0
    assert found["weights"].keys() == {"1-11", "2-12"}
    assert all(0.0 <= weight <= 1.0 for weight in found["weights"].values())
    assert client.post("/api/maps/loops/decisions", json={"action": "reject", "from": 11, "to": 1}).status_code == 200
    assert client.get(URL).json()["stale"]
    client.post(URL)
    again = done(client)
    assert again["weights"].keys() == {"2-12"} and not again["stale"]
