"""Only what has a place is placed."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from server.browse.map_view import MapView
from server.browse.snapshot import Snapshot
from server.catalog import MapFile
from server.scene.placed import LinkKind, PlacedGraph
from slam.database import MapReader
from slam.types import Tier
from tests.graphs import circles, write_map
from tests.unit.server.scene.room_map import LOOPS, NODES, REFUSED, true_pose


def test_nodes_links_and_tiers_are_those_of_the_file(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    assert graph.ids.tolist() == list(range(1, NODES + 1))
    np.testing.assert_allclose(graph.positions[4], true_pose(5)[:3, 3], atol=1e-6)
    assert len(graph.links[LinkKind.NEIGHBOR]) == NODES - 1
    for kind, loop in ((LinkKind.LOOP, 13), (LinkKind.PROXIMITY, 16), (LinkKind.USER, 20)):
        assert set(graph.pair_of(kind, 0)) == {loop, LOOPS[loop][0]}
    order = (Tier.STM, Tier.WM, Tier.LTM)
    assert [order[code] for code in graph.tiers] == [snapshot.tiers[i] for i in graph.ids.tolist()]


def test_a_loop_that_was_refused_and_is_no_link_is_there_as_refused(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    assert graph.pair_of(LinkKind.REFUSED, 0) == REFUSED
    assert len(graph.links[LinkKind.REFUSED]) == 1


def test_a_node_without_a_finite_pose_has_no_place_and_nor_have_its_links(room_map: Path) -> None:
    broken = Snapshot(MapReader(room_map), 1, {})
    broken.poses[5] = np.full((4, 4), np.nan)
    graph = PlacedGraph.of(broken)
    assert 5 not in graph.rows
    assert len(graph) == NODES - 1
    assert len(graph.links[LinkKind.NEIGHBOR]) == NODES - 3


def test_when_a_map_grows_links_are_added_at_the_end(tmp_path: Path) -> None:
    small, large = circles(40, 4), circles(60, 4)
    graphs = []
    for name, made in (("small", small), ("large", large)):
        view = MapView(MapFile(name, name, write_map(tmp_path / f"{name}.db", made)))
        graphs.append(PlacedGraph.of(view.snapshot()))
    before, after = (graph.links[LinkKind.NEIGHBOR] for graph in graphs)
    np.testing.assert_array_equal(after[: len(before)], before)


def test_a_map_without_nodes_is_an_empty_graph(shared_data: Path, tmp_path: Path) -> None:
    source = sorted((shared_data / "rtabmap_db" / "empty_schema").glob("*.db"))[0]
    path = Path(shutil.copy(source, tmp_path / "empty.db"))
    graph = PlacedGraph.of(MapView(MapFile("empty", "empty", path)).snapshot())
    assert len(graph) == 0
    assert graph.positions.shape == (0, 3)
