"""Served maps and a client that has the token."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from server.settings import Settings
from tests.unit.server.loop_map import write_loop_map
from tests.unit.server.running import TOKEN, RunningApp, StartApp


@pytest.fixture(scope="session")
def written_map(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A closed map; tests that change it take a copy."""
    path = tmp_path_factory.mktemp("written") / "loops.db"
    write_loop_map(path)
    return path


@pytest.fixture(scope="session")
def page_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page that stands for the real one."""
    folder = tmp_path_factory.mktemp("web")
    (folder / "index.html").write_text(
        '<!doctype html><script type="importmap">{"imports":{}}</script><script type="module" src="app.js"></script>'
    )
    (folder / "app.js").write_text("export {};\n")
    return folder


@pytest.fixture
def maps_folder(written_map: Path, tmp_path: Path) -> Path:
    """A served folder: a map, one in a folder below, and a file that is none."""
    folder = tmp_path / "maps"
    (folder / "lab").mkdir(parents=True)
    shutil.copy(written_map, folder / "loops.db")
    shutil.copy(written_map, folder / "lab" / "second.db")
    (folder / "broken.db").write_text("hello")
    (folder / "notes.txt").write_text("not a map")
    return folder


@pytest.fixture
def start_app(page_folder: Path, tmp_path: Path) -> Iterator[StartApp]:
    """Starts the app for some roots."""
    with ExitStack() as stack:

        def start(*roots: Path, authorized: bool = True, **settings: Any) -> RunningApp:
            usual = {"roots": roots, "token": TOKEN, "port": 0, "scratch": tmp_path / "scratch"}
            chosen = Settings(**{**usual, **settings})
            return stack.enter_context(RunningApp(chosen, page_folder, authorized=authorized))

        yield start


@pytest.fixture
def client(start_app: StartApp, maps_folder: Path) -> RunningApp:
    """A client of the served folder."""
    return start_app(maps_folder, sources=(maps_folder,))
