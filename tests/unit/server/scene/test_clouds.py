"""Points are sent once; afterwards only poses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from server.browse.snapshot import Snapshot
from server.scene.clouds import CloudLayer
from server.scene.placed import PlacedGraph
from slam.database import MapReader
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.placing import first
from tests.unit.server.scene.room_map import HALF, write_room_map


def loaded(viewer: Any, snapshot: Snapshot) -> tuple[CloudLayer, PlacedGraph]:
    layer, graph = CloudLayer(viewer.scene), PlacedGraph.of(snapshot)
    layer.draw(graph, graph.rows, visible=True)
    layer.load(snapshot.reader, layer.missing)
    return layer, graph


def test_a_loop_closure_moves_clouds_and_sends_no_point(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer, graph = loaded(viewer, snapshot)
    assert [kind for kind, _ in sent.take()].count("PointCloud") == 12
    moved = graph.T_map.copy()
    moved[6:, :3, 3] += 0.5
    layer.draw(replace(graph, T_map=moved), graph.rows, visible=True)
    messages = sent.take()
    assert {kind for kind, _ in messages} == {"SetPosition"}
    assert {name for _, name in messages} == {f"/cloud/{i}" for i in range(7, 13)}
    assert layer.missing == []
    np.testing.assert_allclose(viewer.scene.get_handle_by_name("/cloud/9").position, moved[8, :3, 3])


def test_hiding_and_showing_sends_no_point(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer, graph = loaded(viewer, snapshot)
    sent.take()
    layer.draw(graph, (), visible=False)
    layer.draw(graph, graph.rows, visible=True)
    assert {kind for kind, _ in sent.take()} == {"SetSceneNodeVisibility"}


def test_a_cloud_of_a_node_that_went_is_removed(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    layer, graph = loaded(viewer, snapshot)
    sent.take()
    layer.draw(first(graph, 8), range(1, 9), visible=True)
    assert {name for kind, name in sent.take() if kind == "RemoveSceneNode"} == {f"/cloud/{i}" for i in range(9, 13)}
    assert np.abs(layer.sample()[:, :2]).max() <= HALF + 0.02


def test_nodes_without_images_are_left_out_and_not_tried_again(viewer: Any, tmp_path: Path) -> None:
    reader = MapReader(write_room_map(tmp_path / "bare.db", 5, images=False))
    snapshot = Snapshot(reader, 1, {})
    layer, graph = CloudLayer(viewer.scene), PlacedGraph.of(snapshot)
    layer.draw(graph, graph.rows, visible=True)
    assert layer.missing == [1, 2, 3, 4, 5]
    layer.load(reader, [1, 2])
    assert layer.missing == [3, 4, 5]
    assert len(layer.sample()) == 0
