"""Only maps are removed, whole, and not under a writer."""

from __future__ import annotations

from pathlib import Path

import pytest

from slam.database import MapWriter, remove_map
from slam.errors import DatabaseError, MapBusyError
from slam.params import Params
from tests.unit.database.map_records import write_map
from tests.unit.database.test_reader import killed_map


def test_a_map_goes_with_all_that_lies_beside_it(tmp_path: Path) -> None:
    remove_map(write_map(tmp_path / "map.db"))
    remove_map(killed_map(tmp_path / "killed.db"))
    remove_map(tmp_path / "never.db")
    assert list(tmp_path.iterdir()) == []


def test_what_is_no_map_stays(tmp_path: Path) -> None:
    for name, content in (("notes.txt", b"long notes, which nobody wants to lose" * 9), ("empty", b"")):
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(DatabaseError, match="a map file of RTAB-Map or slamdeck is needed"):
            remove_map(path)
        assert path.read_bytes() == content
    (tmp_path / "folder").mkdir()
    with pytest.raises(DatabaseError, match="is a folder"):
        remove_map(tmp_path / "folder")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["empty", "folder", "notes.txt"]


def test_a_map_that_is_being_written_stays(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source=""):
        with pytest.raises(MapBusyError):
            remove_map(path)
        assert path.exists()
