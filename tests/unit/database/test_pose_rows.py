"""Poses that changed are read with the others, and end up where RTAB-Map looks for them."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np

from slam.database import MapReader, MapWriter, NodeRecord
from slam.params import Params
from slam.types import Odometry, Update
from tests.nodes import at, features, node, random_descriptors


def add(writer: MapWriter, node_id: int, poses: dict[int, np.ndarray[tuple[int, ...], np.dtype[np.float64]]]) -> None:
    items = features(random_descriptors(4, node_id))
    new = node(node_id, items, -np.arange(1, 5, dtype=np.int32))
    odometry = Odometry(new.T_odom_base, np.eye(6), items, 30, 25, True, None, 1.0)
    update = Update(node_id, new.stamp, odometry, at(float(node_id), 3.0), new)
    writer.add_node(NodeRecord(node=new, update=update, poses=poses))


def stored_whole(path: Path) -> bool:
    with closing(sqlite3.connect(path)) as database:
        rows = database.execute("SELECT count(*) FROM deck_pose").fetchone()[0]
        blob = database.execute("SELECT opt_poses FROM Admin").fetchone()[0]
    return rows == 0 and blob is not None


def test_a_node_writes_only_what_changed_and_the_end_of_the_session_all(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    writer = MapWriter.create(path, Params(), seed=0, source="made up")
    add(writer, 1, {1: at(1.0)})
    add(writer, 2, {2: at(2.0)})
    add(writer, 3, {3: at(3.0), 1: at(1.5)})
    reader = MapReader(path)
    expected = {1: at(1.5), 2: at(2.0), 3: at(3.0)}
    assert reader.info().has_poses
    assert reader.poses().keys() == expected.keys()
    for node_id, T in expected.items():
        np.testing.assert_array_equal(reader.poses()[node_id], T)
    np.testing.assert_array_equal(reader.last_pose(), at(3.0, 3.0))
    writer.close_session(ram_ids=[1, 2, 3], ram_word_ids=[], params=Params())
    writer.close()
    assert stored_whole(path)
    for node_id, T in expected.items():
        np.testing.assert_allclose(reader.poses()[node_id], T, atol=1e-6)
    last = reader.last_pose()
    assert last is not None
    np.testing.assert_allclose(last, at(3.0, 3.0), atol=1e-6)


def test_a_killed_session_is_healed_with_its_poses(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        add(writer, 1, {1: at(1.0)})
    assert not stored_whole(path), "closed without the end of the session, as by a kill"
    MapWriter.open(path).close()
    assert stored_whole(path)
    assert MapReader(path).poses().keys() == {1}


def test_all_poses_at_once_leave_nothing_of_the_changes(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    with MapWriter.create(path, Params(), seed=0, source="made up") as writer:
        add(writer, 1, {1: at(1.0)})
        writer.save_poses({1: at(9.0)}, None)
        np.testing.assert_allclose(MapReader(path).poses()[1], at(9.0), atol=1e-6)
        last = MapReader(path).last_pose()
        assert last is not None
        np.testing.assert_allclose(last, at(1.0, 3.0), atol=1e-6)
