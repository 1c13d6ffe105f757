"""Reading changes nothing, needs no right to write, and goes on while a writer is at work."""

from __future__ import annotations

import hashlib
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from slam.database import LoopState, MapReader, MapWriter
from slam.errors import DatabaseError
from slam.params import Params
from slam.types import Tier
from tests.unit.database.map_records import pose, posterior, record, write_map
from tests.unit.database.test_killed import ROOT

NOBODY = 65534
WRITE_AND_DIE = """
import os, sys
from pathlib import Path
from slam.database import MapWriter
from slam.params import Params
from tests.unit.database.map_records import record

writer = MapWriter.create(Path(sys.argv[1]), Params(), seed=0, source="")
for node_id in range(1, 4):
    writer.add_node(record(node_id))
os._exit(9)
"""

CALLS: tuple[Callable[[MapReader], Any], ...] = (
    lambda reader: reader.info(),
    lambda reader: reader.nodes(),
    lambda reader: reader.node(1),
    lambda reader: reader.links(),
    lambda reader: reader.poses(),
    lambda reader: reader.last_pose(),
    lambda reader: reader.grid(),
    lambda reader: reader.trajectory(),
    lambda reader: reader.image_bgr(1),
    lambda reader: reader.depth_m(1),
    lambda reader: reader.camera(1),
    lambda reader: reader.features(1),
    lambda reader: reader.words(),
    lambda reader: reader.local_grid(1),
    lambda reader: reader.statistics(),
    lambda reader: reader.statistic_names(),
    lambda reader: reader.wm_states(),
    lambda reader: reader.memory_ids(),
    lambda reader: reader.updates(),
    lambda reader: reader.hypotheses(2),
    lambda reader: reader.beliefs(),
    lambda reader: reader.candidates(),
    lambda reader: reader.journal(),
    lambda reader: reader.parameters(),
    lambda reader: reader.parameter_changes(),
    lambda reader: reader.sessions(),
    lambda reader: reader.nodes_with("depth"),
)


def state(folder: Path) -> dict[str, tuple[str, int]]:
    """Hash and time of change of every file in a folder."""
    return {
        path.name: (hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_mtime_ns)
        for path in sorted(folder.iterdir())
    }


def killed_map(path: Path) -> Path:
    """A map whose writer died without a word, with its log beside it."""
    subprocess.run([sys.executable, "-c", WRITE_AND_DIE, str(path)], cwd=ROOT, check=False)
    assert path.with_name(path.name + "-wal").stat().st_size > 0
    return path


@contextmanager
def unprivileged_folder() -> Iterator[Path]:
    """A folder that this process may not write while the body runs."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield folder
        folder.chmod(0o700)


@contextmanager
def without_rights(folder: Path, folder_mode: int = 0o555) -> Iterator[None]:
    """Take the right to write the files of a folder (and the folder) away, from root as well."""
    for path in folder.iterdir():
        path.chmod(0o444)
    folder.chmod(folder_mode)
    root = os.geteuid() == 0
    if root:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        if root:
            os.seteuid(0)


def test_reading_changes_nothing(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db")
    before = state(tmp_path)
    reader = MapReader(path)
    for call in CALLS:
        call(reader)
    assert state(tmp_path) == before


def test_reading_real_files_changes_nothing(shared_data: Path, tmp_path: Path) -> None:
    for path in sorted((shared_data / "rtabmap_db").rglob("*.db")):
        copy = Path(shutil.copy(path, tmp_path / path.name))
        before = state(tmp_path)
        MapReader(copy).info()
        MapReader(copy).links()
        assert state(tmp_path) == before


def test_reading_a_killed_file_changes_nothing(tmp_path: Path) -> None:
    path = killed_map(tmp_path / "map.db")
    before = state(tmp_path)
    assert len(before) >= 3
    reader = MapReader(path)
    assert reader.node_ids().tolist() == [1, 2, 3]
    for call in CALLS:
        call(reader)
    assert state(tmp_path) == before


def test_a_file_copied_without_its_log_is_read_as_it_is(tmp_path: Path) -> None:
    path = write_map(tmp_path / "map.db")
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA journal_mode=WAL")
    connection.close()
    before = state(tmp_path)
    assert list(before) == ["map.db"]
    assert len(MapReader(path).nodes()) == 5
    assert state(tmp_path) == before


def test_a_log_without_its_index_gets_one_and_nothing_else_changes(tmp_path: Path) -> None:
    path = killed_map(tmp_path / "map.db")
    path.with_name("map.db-shm").unlink()
    before = state(tmp_path)
    assert len(MapReader(path).nodes()) == 3
    after = state(tmp_path)
    assert {name for name in after if name not in before} == {"map.db-shm"}
    assert {name: after[name] for name in before} == before
    assert len(MapReader(path).nodes()) == 3
    assert state(tmp_path) == after


def test_a_log_that_holds_nothing_yet_is_no_hindrance(tmp_path: Path) -> None:
    """As a writer leaves it that is killed just when it has written the log's header."""
    path = killed_map(tmp_path / "map.db")
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("PRAGMA wal_checkpoint")
        log = path.with_name("map.db-wal").read_bytes()
        index = path.with_name("map.db-shm").read_bytes()
    (tmp_path / "map.db-wal").write_bytes(log[:32])
    (tmp_path / "map.db-shm").write_bytes(index)
    before = state(tmp_path)
    assert len(MapReader(path).nodes()) == 3
    assert state(tmp_path) == before
    MapWriter.open(path).close()
    assert len(MapReader(path).nodes()) == 3


def test_a_killed_file_is_healed_while_threads_of_the_process_read_it(tmp_path: Path) -> None:
    path = killed_map(tmp_path / "map.db")
    done, errors = threading.Event(), []

    def read() -> None:
        while not done.is_set():
            try:
                assert len(MapReader(path).nodes()) == 3
            except (DatabaseError, AssertionError) as error:
                errors.append(error)

    threads = [threading.Thread(target=read) for _ in range(3)]
    for thread in threads:
        thread.start()
    MapWriter.open(path).close()
    done.set()
    for thread in threads:
        thread.join()
    assert not errors
    assert [item.name for item in tmp_path.iterdir()] == ["map.db"]


@pytest.mark.skipif(os.name != "posix", reason="takes rights away as on POSIX")
@pytest.mark.parametrize("make", [write_map, killed_map])
def test_a_folder_without_the_right_to_write_can_be_read_but_not_written(make: Callable[[Path], Path]) -> None:
    with unprivileged_folder() as folder:
        path = make(folder / "map.db")
        before = state(folder)
        with without_rights(folder):
            reader = MapReader(path)
            for call in CALLS:
                call(reader)
            with pytest.raises(DatabaseError, match="the folder must be writable"):
                MapWriter.open(path)
            with pytest.raises(DatabaseError, match="the folder must be writable"):
                MapWriter.create(folder / "new.db", Params(), seed=0, source="")
        assert state(folder) == before


@pytest.mark.skipif(os.name != "posix", reason="takes rights away as on POSIX")
def test_a_file_without_the_right_to_write_is_refused_by_the_writer() -> None:
    with unprivileged_folder() as folder:
        path = write_map(folder / "map.db")
        with without_rights(folder, 0o777), pytest.raises(DatabaseError, match="must be writable"):
            MapWriter.open(path)
        assert len(MapReader(path).nodes()) == 5


def test_each_commit_of_a_writer_is_seen_at_once(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        reader = MapReader(path)
        assert len(reader.nodes()) == 0
        for node_id in range(1, 4):
            writer.add_node(record(node_id))
            assert reader.node_ids().tolist() == list(range(1, node_id + 1))
            for call in CALLS:
                if node_id > 1:
                    call(reader)
    assert len(reader.nodes()) == 3


def test_readers_in_threads_go_on_while_a_writer_writes_opens_and_closes(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    MapWriter.create(path, Params(), seed=0, source="").close()
    done, errors, counts = threading.Event(), [], []

    def read() -> None:
        reader = MapReader(path)
        while not done.is_set():
            try:
                ids = reader.node_ids()
                counts.append(len(ids))
                assert len(reader.statistics().ids) >= len(ids)
                assert len(reader.poses()) >= len(ids)
            except (DatabaseError, AssertionError) as error:
                errors.append(error)

    threads = [threading.Thread(target=read) for _ in range(2)]
    for thread in threads:
        thread.start()
    node_id = 0
    for _ in range(8):
        with MapWriter.open(path) as writer:
            map_id = writer.start_session(Params(), seed=0, source="")
            for _ in range(3):
                node_id += 1
                writer.add_node(record(node_id, map_id=map_id))
    done.set()
    for thread in threads:
        thread.join()
    assert not errors
    assert len(counts) > 4


def test_the_updates_are_read_back(tmp_path: Path) -> None:
    reader = MapReader(write_map(tmp_path / "map.db", 5))
    updates = reader.updates(after=2)
    assert [row.id for row in updates] == [3, 4, 5]
    row, expected = updates[0], record(3).update
    assert row.T_map_base is not None
    np.testing.assert_array_equal(row.T_map_base, pose(3))
    assert dict(row.tiers) == {3: Tier.STM, 2: Tier.WM}
    assert expected.posterior is not None
    assert (row.best_id, row.value) == (expected.posterior.best_id, expected.posterior.value)
    assert (row.frame_index, row.stamp, row.weight) == (30, 103.0, 0)
    assert (row.matches, row.inliers, row.keyframe, row.odometry_ms, row.time_ms) == (120, 80, True, 12.5, 33.25)
    assert np.isnan(reader.updates()[0].value)


def test_the_best_twenty_places_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    belief = posterior(np.random.default_rng(3), 50)
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        update = record(1).update
        changed = type(update)(update.frame_index, update.stamp, update.odometry, None, posterior=belief)
        writer.add_node(record(1, update=changed))
    found = MapReader(path).hypotheses(1)
    assert found is not None
    best = np.sort(np.argsort(-belief.probability)[:20])
    np.testing.assert_array_equal(found.node_ids, belief.node_ids[best])
    np.testing.assert_array_equal(found.probability, belief.probability[best])
    np.testing.assert_array_equal(found.likelihood, belief.likelihood[best])
    assert (found.virtual_place, found.virtual_likelihood) == (belief.virtual_place, belief.virtual_likelihood)
    assert MapReader(path).updates()[0].value == belief.value
    assert MapReader(path).hypotheses(2) is None


def test_all_beliefs_at_once_are_what_each_is(tmp_path: Path) -> None:
    reader = MapReader(write_map(tmp_path / "map.db", 4))
    found = reader.beliefs()
    assert found
    for update_id in (1, 2, 3, 4, 5):
        alone, known = reader.hypotheses(update_id), found.get(update_id)
        assert (alone is None) == (known is None)
        if alone is not None and known is not None:
            for name in ("node_ids", "likelihood", "probability", "virtual_place", "virtual_likelihood"):
                np.testing.assert_array_equal(getattr(known, name), getattr(alone, name))
    assert reader.beliefs(max(found)) == {}


def test_candidates_come_with_their_evidence(tmp_path: Path) -> None:
    reader = MapReader(write_map(tmp_path / "map.db", 3))
    rows = reader.candidates()
    assert [(row.id, row.update_id, row.state) for row in rows] == [
        (1, 2, LoopState.ACCEPTED),
        (2, 2, LoopState.REFUSED),
        (3, 3, LoopState.ACCEPTED),
        (4, 3, LoopState.REFUSED),
    ]
    accepted, refused = (row.candidate for row in reader.candidates(after=2))
    assert accepted.T_from_to is not None
    assert accepted.information is not None
    np.testing.assert_array_equal(accepted.T_from_to, pose(1))
    np.testing.assert_array_equal(accepted.information, 50 * np.eye(6))
    assert refused.refusal == record(3).update.candidates[1].refusal
    assert np.isnan(refused.posterior)


def test_the_trajectory_is_exact(tmp_path: Path) -> None:
    found = MapReader(write_map(tmp_path / "map.db", 2)).trajectory()
    expected = [*record(1).frames, *record(2).frames]
    assert [(f.index, f.stamp, f.node_id, f.inliers, f.lost) for f in found] == [
        (f.index, f.stamp, f.node_id, f.inliers, f.lost) for f in expected
    ]
    assert found[2].T_node_base is not None
    np.testing.assert_array_equal(found[2].T_node_base, pose(1))
    assert found[3].T_node_base is None


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="") as writer:
        writer.add_node(record(1, image_bgr=None, depth_m=None, grid=None))
    reader = MapReader(path)
    with pytest.raises(DatabaseError, match=r"map\.db: reading node 7 failed: node 7 is not in the map"):
        reader.node(7)
    for call, what in ((reader.image_bgr, "image"), (reader.depth_m, "depth image")):
        with pytest.raises(DatabaseError, match=f"node 1 has no {what}"):
            call(1)
    assert reader.local_grid(1) is None
    assert reader.nodes_with("image").tolist() == []
    assert len(reader.features(7)[1]) == 0


def test_the_summary(tmp_path: Path) -> None:
    params = Params().changed({"Rtabmap/LoopThr": 0.2, "Kp/MaxFeatures": 400})
    path = write_map(tmp_path / "map.db", 5, params)
    info = MapReader(path).info()
    assert (info.version, info.sessions, info.nodes, info.dropped) == ("0.20.0", 1, 5, 0)
    assert info.links == {"Neighbor": 4}
    assert (info.words, info.features, info.size_bytes) == (50, 200, path.stat().st_size)
    assert info.parameters == {"Kp/MaxFeatures": "400", "Rtabmap/LoopThr": "0.2"}
    assert (info.seeds, info.sources, info.clean, info.has_poses) == ((7,), ("made up",), True, True)
    assert (info.first_stamp, info.last_stamp) == (101.0, 105.0)
    assert info.bytes_by_kind["image"] == sum(len(MapReader(path).image(i)) for i in range(1, 6))
    assert MapReader(path).info(sizes=False).bytes_by_kind == {}
