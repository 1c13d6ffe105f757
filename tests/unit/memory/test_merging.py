"""Rehearsal that keeps the newer node, and sessions that begin with a loop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from slam.database import MapReader, MapWriter
from slam.params import Params
from slam.trajectory import assemble
from slam.types import WEIGHT_INVALID, LinkType
from tests.ghosts import GhostWorld, visited

EVERY = Params().changed({"Rtabmap/DetectionRate": 0.0})
NEWER = EVERY.changed({"Mem/RehearsalIdUpdatedToNewOne": True})
WAITS = EVERY.changed({"Rtabmap/StartNewMapOnLoopClosure": True, "Mem/STMSize": 2})


def test_the_newer_of_two_that_look_alike_stays_where_the_robot_stands(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    slam, updates = visited([4, 5, 5, 6], NEWER, MapWriter.create(path, NEWER, seed=0, source="ghosts"))
    slam.close()
    assert set(slam.graph.poses) == {1, 3, 4}
    assert slam.memory.weights == {1: 0, 3: 1, 4: 0}
    assert {pair: link.type for pair, link in slam.graph.links.items()} == {
        (1, 3): LinkType.NEIGHBOR,
        (3, 4): LinkType.NEIGHBOR,
    }
    reader = MapReader(path)
    table = reader.nodes()
    assert table.weights.tolist() == [0, WEIGHT_INVALID, 1, 0]
    (marker,) = [link for link in reader.links() if link.T_from_to is None]
    assert (marker.from_id, marker.to_id) == (2, 3)
    assert {link.pair for link in reader.links() if link.T_from_to is not None} == {(1, 3), (3, 4)}
    poses = reader.poses()
    true = [GhostWorld(50).T_world_base(k) for k in (4, 5, 5, 6)]
    path_of = assemble(reader.trajectory(), poses)
    assert path_of.node_ids.tolist() == [1, 3, 3, 4]
    np.testing.assert_allclose(path_of.T_map_base, [np.linalg.inv(true[0]) @ T for T in true], atol=1e-5)
    assert [update.weight for update in updates] == [0, 0, 1, 0]


def test_the_label_of_a_session_goes_to_the_newer_one(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    slam, _ = visited([4, 4, 5], NEWER, MapWriter.create(path, NEWER, seed=0, source="ghosts"))
    slam.close()
    assert MapReader(path).nodes().labels == (None, "map0", None)
    assert slam.memory.weights == {2: 1, 3: 0}


def test_with_intermediate_nodes_between_the_older_one_becomes_one_of_them() -> None:
    between = NEWER.changed({"Rtabmap/DetectionRate": 1.0, "Rtabmap/CreateIntermediateNodes": True})
    slam, updates = visited([5, 6, 5], between)
    assert [update.weight for update in updates] == [0, -1, 1]
    assert slam.memory.weights == {1: -1, 2: -1, 3: 1}
    assert slam.graph.between == {1, 2}
    assert list(slam.memory.nodes) == list(slam.memory.stm) == [3]
    assert sorted(slam.memory.with_between([3])) == [1, 2, 3]


@pytest.mark.parametrize("file", [False, True])
def test_beside_a_map_a_session_waits_for_a_loop(tmp_path: Path, file: bool) -> None:
    path = tmp_path / "map.db"
    writer = MapWriter.create(path, WAITS, seed=0, source="ghosts") if file else None
    # A street, then odometry begins anew far from it, and comes to a place that was seen.
    way = [*range(12), 30, 31, 32, 5, 6]
    slam, updates = visited(way, WAITS, writer, begins=[12])
    slam.close()
    assert [update.node is None for update in updates[12:15]] == [True, True, True]
    first = updates[15].node
    assert first is not None
    assert (first.id, first.map_id) == (13, first.map_id)
    assert any(c.refusal is None for c in updates[15].candidates)
    assert len(slam.graph.component(1)) == len(slam.graph) == 14
    assert [frame.node_id for frame in slam.frames[12:]] == [0, 0, 0, 13, 14]
    assert all(frame.T_node_base is None for frame in slam.frames[12:15])
    if file:
        reader = MapReader(path)
        assert reader.nodes().ids.tolist() == list(range(1, 15))
        assert [session.nodes for session in reader.sessions()] == [12, 2]


def test_the_first_session_of_all_waits_for_nothing() -> None:
    slam, _ = visited([1, 2, 3], WAITS)
    assert len(slam.graph) == 3
