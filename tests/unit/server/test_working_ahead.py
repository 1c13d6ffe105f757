"""What the page asks first of the map that was written last is worked out before anybody asks."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from server.services import Services
from server.settings import Settings
from tests.graphs import circles, write_map


def serving(folder: Path) -> Services:
    return Services(Settings((folder,)))


def test_the_map_that_was_written_last_has_been_read(tmp_path: Path) -> None:
    for age, name in enumerate(("new", "old")):
        path = write_map(tmp_path / f"{name}.db", circles())
        os.utime(path, (1e9 - age, 1e9 - age))
    services = serving(tmp_path)
    services.read_ahead()
    assert services.view("new").revision == 1
    assert services.view("old").revision == 0


@pytest.mark.parametrize("content", [None, b"no database"])
def test_nothing_to_read_is_no_failure(content: bytes | None, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "broken.db").write_bytes(content)
    serving(tmp_path).read_ahead()
