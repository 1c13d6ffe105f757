"""A small recorded folder, made by the tour, to read and to damage."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from slam.sensors import open_source
from slam.sensors.tum_writer import write_tum_folder

FRAMES = 5


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("recorded") / "walk"
    write_tum_folder(open_source("tour:width=160,height=120"), folder, FRAMES)
    return folder


@pytest.fixture
def folder(recorded: Path, tmp_path: Path) -> Path:
    """A copy that a test may change."""
    return Path(shutil.copytree(recorded, tmp_path / "walk"))
