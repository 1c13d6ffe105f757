"""A writer that is killed loses the update under way and nothing else."""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.params import Params
from tests.unit.database.map_records import record
from tests.unit.database.test_writer import assert_same_node

ROOT = Path(__file__).resolve().parents[3]
WRITE = """
import sys
from pathlib import Path
from slam.database import MapReader, MapWriter
from slam.params import Params
from tests.unit.database.map_records import record

path, nodes_per_session = Path(sys.argv[1]), int(sys.argv[2])
while True:
    if path.exists():
        writer = MapWriter.open(path)
        first = int(MapReader(path).node_ids().max(initial=0)) + 1
        map_id = writer.start_session(Params(), seed=1, source="again")
    else:
        writer, first, map_id = MapWriter.create(path, Params(), seed=0, source="first"), 1, 0
    # The log is merged after every other node, so that some kills fall into that.
    writer._connection.connection.driver_connection.execute("PRAGMA wal_autocheckpoint = 20")
    for node_id in range(first, first + nodes_per_session):
        writer.add_node(record(node_id, map_id=map_id))
        print(node_id, flush=True)
    writer.close_session(ram_ids=[node_id], ram_word_ids=[], params=Params())
    writer.close()
"""


def write_until_killed(path: Path, seconds: float, nodes_per_session: int = 10_000) -> int:
    """Start a process that adds nodes, kill it ``seconds`` after its first one; the last node that it said was in."""
    command = [sys.executable, "-c", WRITE, str(path), str(nodes_per_session)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    said = process.stdout.readline()
    time.sleep(seconds)
    process.send_signal(signal.SIGKILL)
    lines = [said, *process.stdout.readlines()]
    process.stdout.close()
    assert process.wait() == -signal.SIGKILL
    return max(int(line) for line in lines if line.endswith("\n") and line.strip())


def check_complete(path: Path, at_least: int) -> int:
    """All that was said to be in is in, whole, and at most one node more; the number of nodes."""
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    reader = MapReader(path)
    ids = reader.node_ids().tolist()
    assert ids == list(range(1, len(ids) + 1))
    assert at_least <= len(ids) <= at_least + 1
    assert [link.pair for link in reader.links()] == [(i - 1, i) for i in ids[1:]]
    assert sorted(reader.poses()) == ids
    assert reader.statistics().ids.tolist() == ids
    assert [row.id for row in reader.updates()] == ids
    assert len(reader.trajectory()) == 2 * len(ids)
    assert reader.words().ids.tolist() == [1000 * i + j for i in ids for j in range(1, 11)]
    map_ids = reader.nodes().map_ids
    for i in ids:
        assert_same_node(reader, record(i, map_id=int(map_ids[i - 1])))
    return len(ids)


@pytest.mark.skipif(os.name != "posix", reason="kills a process with SIGKILL")
@pytest.mark.parametrize("nodes_per_session", [10_000, 2])
def test_killed_at_any_moment(tmp_path: Path, nodes_per_session: int) -> None:
    """While nodes are added, while the log is merged, and while sessions are closed and opened."""
    path = tmp_path / "map.db"
    moments = random.Random(nodes_per_session)
    for _ in range(3):
        check_complete(path, write_until_killed(path, moments.uniform(0.0, 0.25), nodes_per_session))
    assert MapReader(path).info().sessions >= 3


@pytest.mark.skipif(os.name != "posix", reason="kills a process with SIGKILL")
def test_a_killed_file_is_healed(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    count = check_complete(path, write_until_killed(path, 0.1))
    assert path.with_name("map.db-wal").exists()
    assert MapReader(path).sessions()[0].closed is None
    MapWriter.open(path).close()
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]
    assert check_complete(path, count) == count
    reader = MapReader(path)
    nodes, words = reader.memory_ids()
    assert nodes.tolist() == reader.node_ids().tolist()  # the last wm_state has them all
    assert words.tolist() == reader.words().ids.tolist()
    session = reader.sessions()[0]
    assert session.closed is not None
    assert not session.clean
    assert not reader.info().clean


def test_healing_keeps_out_what_was_in_long_term_memory(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        for i in range(1, 6):
            writer.add_node(record(i, wm_ids=(2, 4, 5) if i == 5 else None))
        writer.add_node(record(6, wm_ids=None))
    MapWriter.open(path).close()
    nodes, words = MapReader(path).memory_ids()
    assert nodes.tolist() == [2, 4, 5, 6]
    assert set((words // 1000).tolist()) == {2, 4, 5, 6}


def test_a_file_that_was_begun_but_not_finished_is_no_map_and_no_hindrance(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    for name in ("map.db.new", "map.db-wal", "map.db-shm"):
        (tmp_path / name).write_bytes(b"left over")
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1))
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]
    assert_same_node(MapReader(path), record(1))
    assert np.isfinite(MapReader(path).nodes().T_odom).all()
