"""The maps that are served are those under the roots."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.catalog import Catalog
from server.errors import UnknownMapError
from slam.errors import DatabaseError


def make(*paths: Path) -> None:
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"map")


def test_files_below_a_folder_get_flat_ids(tmp_path: Path) -> None:
    make(tmp_path / "a.db", tmp_path / "lab" / "b.db", tmp_path / "a.txt", tmp_path / ".hidden.db")
    make(tmp_path / "1" / "2" / "3" / "4" / "deep.db", tmp_path / ".git" / "x.db")
    assert [(file.id, file.name) for file in Catalog([tmp_path]).files()] == [("a", "a"), ("lab~b", "lab/b")]


def test_single_files_and_folders_together_have_different_ids(tmp_path: Path) -> None:
    one, two = tmp_path / "one" / "map.db", tmp_path / "two" / "map.db"
    make(one, two, tmp_path / "three" / "map.db")
    catalog = Catalog([one, two, tmp_path / "three"])
    assert {file.id: file.path for file in catalog.files()} == {
        "map": one,
        "map-2": two,
        "map-3": tmp_path / "three" / "map.db",
    }


def test_a_link_that_leads_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    make(tmp_path / "outside.db", tmp_path / "served" / "inside.db")
    (tmp_path / "served" / "leak.db").symlink_to(tmp_path / "outside.db")
    assert [file.id for file in Catalog([tmp_path / "served"]).files()] == ["inside"]


def test_a_new_file_is_found_and_one_that_is_gone_is_not(tmp_path: Path) -> None:
    catalog = Catalog([tmp_path])
    with pytest.raises(UnknownMapError, match="'late'"):
        catalog.find("late")
    make(tmp_path / "late.db")
    assert catalog.find("late").path == tmp_path / "late.db"
    (tmp_path / "late.db").unlink()
    with pytest.raises(UnknownMapError):
        catalog.find("late")


@pytest.mark.parametrize("name", ["../out", "/etc/x", "a/b", ".."])
def test_a_new_map_stays_in_the_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(DatabaseError):
        Catalog([tmp_path]).new_path(name)


def test_a_new_map_overwrites_nothing_and_needs_a_folder(tmp_path: Path) -> None:
    make(tmp_path / "a.db")
    assert Catalog([tmp_path]).new_path("b") == tmp_path / "b.db"
    with pytest.raises(DatabaseError, match="exists"):
        Catalog([tmp_path]).new_path("a")
    with pytest.raises(DatabaseError, match="folder"):
        Catalog([tmp_path / "a.db"]).new_path("b")
