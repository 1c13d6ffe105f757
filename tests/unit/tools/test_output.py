"""A new map file appears whole or not at all."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from slam.errors import DatabaseError, MapBusyError
from slam.tools.output import new_map


def test_it_gets_its_name_when_it_is_finished(tmp_path: Path) -> None:
    with new_map(tmp_path / "map.db") as part:
        part.write_text("whole")
        assert not (tmp_path / "map.db").exists() and part.parent == tmp_path
    assert [path.name for path in tmp_path.iterdir()] == ["map.db"]


def test_nothing_is_left_of_one_that_failed(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no"), new_map(tmp_path / "map.db") as part:
        part.write_text("half")
        raise ValueError("no")
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_stays_until_the_new_one_is_finished(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    path.write_text("old")
    with pytest.raises(DatabaseError, match="--force"), new_map(path):
        pass
    with pytest.raises(ValueError, match="no"), new_map(path, force=True) as part:
        part.write_text("half")
        raise ValueError("no")
    assert path.read_text() == "old"
    with pytest.raises(DatabaseError, match="is read"), new_map(path, [path], force=True):
        pass


def test_a_killed_process_leaves_no_half_map_and_does_not_bar_the_next(tmp_path: Path) -> None:
    code = (
        "import os, signal; from pathlib import Path; from slam.tools.output import new_map\n"
        f"with new_map(Path({str(tmp_path / 'map.db')!r})) as part:\n"
        "    part.write_text('half'); os.kill(os.getpid(), signal.SIGKILL)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == -signal.SIGKILL
    assert not (tmp_path / "map.db").exists()
    with new_map(tmp_path / "map.db") as part:
        assert not part.exists()
        part.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["map.db"]


def test_two_do_not_make_the_same_map(tmp_path: Path) -> None:
    with new_map(tmp_path / "map.db") as part:
        part.write_text("")
        with pytest.raises(MapBusyError), new_map(tmp_path / "map.db"):
            pass
        assert part.exists()


@pytest.mark.parametrize(("name", "why"), [("map.txt", "ends in .db"), ("none/map.db", "does not exist")])
def test_names_that_are_no_map_are_refused(tmp_path: Path, name: str, why: str) -> None:
    with pytest.raises(DatabaseError, match=why), new_map(tmp_path / name):
        pass
