"""A small map with images, a viser server, and what is sent through it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from server.browse.map_view import MapView
from server.browse.snapshot import Snapshot
from server.catalog import MapFile
from slam.database import MapReader
from tests.unit.server.scene.room_map import write_room_map


@pytest.fixture(scope="session")
def room_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed map with images; tests that change it take a copy."""
    return write_room_map(tmp_path_factory.mktemp("room") / "room.db")


@pytest.fixture
def snapshot(room_map: Path) -> Snapshot:
    """What the map holds."""
    return MapView(MapFile("room", "room", room_map)).snapshot()


@pytest.fixture
def reader(room_map: Path) -> MapReader:
    """Of the map."""
    return MapReader(room_map)


@pytest.fixture
def viewer() -> Iterator[Any]:
    """A viser server of its own."""
    from server.scene.viewer import Viewer

    made = Viewer()
    yield made
    made.stop()


class Sent:
    """The scene messages since the last look."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._messages: list[Any] = []

    def add(self, message: Any) -> None:
        with self._lock:
            self._messages.append(message)

    def take(self) -> list[tuple[str, str]]:
        """Kind and scene node of each message; for property updates, the property follows the kind."""
        with self._lock:
            messages, self._messages = self._messages, []
        found = []
        for message in messages:
            kind = type(message).__name__.removesuffix("Message")
            if kind == "SceneNodeUpdate":
                kind = f"update {','.join(message.updates)}"
            found.append((kind, message.name))
        return found


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> Sent:
    """Records what goes to the browsers."""
    from viser import SceneApi

    recorder = Sent()
    original = SceneApi._queue_scene_message

    def recording(self: Any, message: Any) -> None:
        recorder.add(message)
        original(self, message)

    monkeypatch.setattr(SceneApi, "_queue_scene_message", recording)
    return recorder
