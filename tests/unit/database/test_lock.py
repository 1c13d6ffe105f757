"""One writer for each file, whoever it is and however it ends."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from slam.database import MapReader, MapWriter
from slam.database.lock import MapLock
from slam.errors import MapBusyError
from slam.params import Params
from tests.unit.database.map_records import record, write_map
from tests.unit.database.test_killed import ROOT

HOLD = """
import sys
from pathlib import Path
from slam.database import MapWriter

writer = MapWriter.open(Path(sys.argv[1]))
print("open", flush=True)
sys.stdin.readline()
"""


def test_a_second_writer_is_told_who_holds_the_file(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db")
    command = [sys.executable, "-c", HOLD, str(path)]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "open\n"
        for use in (MapWriter.open, lambda p: MapWriter.create(p, Params(), seed=0, source="")):
            with pytest.raises(
                MapBusyError, match=rf"map\.db is being written by process {process.pid} \(lock .*map\.db\.lock"
            ):
                use(path)
        assert len(MapReader(path).nodes()) == 5
        process.kill()
    with MapWriter.open(path):
        pass
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]


def test_a_second_writer_of_the_same_process_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        with pytest.raises(MapBusyError, match=f"process {os.getpid()}"):
            MapWriter.open(path)
        writer.add_node(record(1))
    assert len(MapReader(path).nodes()) == 1


def test_the_lock_is_free_after_a_refusal(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    path.write_text("no map, but long enough to be read as one: " + "x" * 200)
    for _ in range(2):
        with pytest.raises(Exception, match="not a database"):
            MapWriter.open(path)
    path.unlink()
    write_map(path)


def test_a_lock_file_left_by_a_killed_writer_is_no_lock(tmp_path: Path) -> None:
    (tmp_path / "map.db.lock").write_text("1\n")
    write_map(tmp_path / "map.db")
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]


def test_releasing_twice_does_not_free_another_one_s_lock(tmp_path: Path) -> None:
    first = MapLock(tmp_path / "map.db")
    first.release()
    second = MapLock(tmp_path / "map.db")
    first.release()
    with pytest.raises(MapBusyError):
        MapLock(tmp_path / "map.db")
    second.release()
    assert list(tmp_path.iterdir()) == []
