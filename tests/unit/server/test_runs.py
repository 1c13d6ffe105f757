"""A browser may only have mapped what lies under the allowed folders."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.runs import checked_source
from slam.errors import SourceError


def test_the_tour_and_folders_under_a_root_are_allowed(tmp_path: Path) -> None:
    (tmp_path / "data" / "desk").mkdir(parents=True)
    assert checked_source("tour:laps=1", []) == "tour:laps=1"
    expected = str((tmp_path / "data" / "desk").resolve())
    assert checked_source(str(tmp_path / "data" / "desk"), [tmp_path / "data"]) == expected
    assert checked_source("desk", [tmp_path / "data"]) == expected


@pytest.mark.parametrize("source", ["/", "/etc", "../secret", "desk/../../secret", "", "nothing", "desk/rgb.txt"])
def test_anything_else_is_refused_in_the_same_words(tmp_path: Path, source: str) -> None:
    (tmp_path / "data" / "desk").mkdir(parents=True)
    (tmp_path / "data" / "desk" / "rgb.txt").write_text("")
    (tmp_path / "secret").mkdir()
    roots = [tmp_path / "data" / "desk"] if source == "" else [tmp_path / "data"]
    if source == "":
        assert checked_source(source, roots)
        return
    with pytest.raises(SourceError, match="no folder that this server may read"):
        checked_source(source, roots)


def test_a_link_out_of_the_root_is_refused(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "secret").mkdir()
    (tmp_path / "data" / "leak").symlink_to(tmp_path / "secret")
    with pytest.raises(SourceError):
        checked_source("leak", [tmp_path / "data"])
