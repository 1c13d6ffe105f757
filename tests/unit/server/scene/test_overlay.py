"""The clouds of both nodes of a link over each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from server.browse.snapshot import Snapshot
from server.scene.clouds import wxyz
from server.scene.colours import DARK
from server.scene.overlay import OverlayLayer
from server.scene.placed import PlacedGraph
from slam.types import Scan
from tests.nodes import features, random_descriptors
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import LOOPS

PAIR = max(LOOPS), LOOPS[max(LOOPS)][0]


def handles(viewer: Any) -> list[Any]:
    return [viewer.scene.get_handle_by_name(f"/overlay/{node_id}") for node_id in PAIR]


def test_the_second_cloud_is_where_the_link_or_the_graph_puts_it(viewer: Any, snapshot: Snapshot, sent: Sent) -> None:
    graph, layer = PlacedGraph.of(snapshot), OverlayLayer(viewer.scene)
    T_from, T_to = (graph.T_map[graph.rows[node_id]] for node_id in PAIR)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK)
    first, second = handles(viewer)
    np.testing.assert_allclose(second.position, T_to[:3, 3])
    assert not np.array_equal(first.colors[0], second.colors[0])
    sent.take()
    assert layer.draw(snapshot, graph, PAIR, "link", DARK)
    link = snapshot.links[min(PAIR), max(PAIR)]
    T_link = T_from @ (link.T_from_to if link.from_id == PAIR[0] else np.linalg.inv(link.T_from_to))
    first, second = handles(viewer)
    np.testing.assert_allclose(second.position, T_link[:3, 3], atol=1e-9)
    np.testing.assert_allclose(second.wxyz, wxyz(T_link), atol=1e-9)
    np.testing.assert_allclose(first.position, T_from[:3, 3])
    assert not any("PointCloud" in kind for kind, _ in sent.take()), "points are sent once"


def test_scans_take_the_place_of_clouds(viewer: Any, snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    graph, layer = PlacedGraph.of(snapshot), OverlayLayer(viewer.scene)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK)
    layer.draw(snapshot, graph, None, None, DARK)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK, of="scan")
    assert min(len(handle.points) for handle in handles(viewer)) > 100, "these nodes have none: points of their depth"
    points = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], np.float32)
    monkeypatch.setitem(vars(snapshot), "scanned", frozenset(PAIR))
    monkeypatch.setattr(type(snapshot.reader), "scan", lambda *_: Scan(points, None))
    layer.draw(snapshot, graph, None, None, DARK)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK, of="scan")
    assert [len(handle.points) for handle in handles(viewer)] == [2, 2]
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK)
    assert min(len(handle.points) for handle in handles(viewer)) > 100


def test_words_take_the_place_of_clouds_in_the_colours_of_both_nodes(
    viewer: Any, snapshot: Snapshot, monkeypatch: pytest.MonkeyPatch
) -> None:
    graph, layer = PlacedGraph.of(snapshot), OverlayLayer(viewer.scene)
    assert not layer.draw(snapshot, graph, PAIR, "poses", DARK, of="words"), "these nodes have none"
    layer.draw(snapshot, graph, None, None, DARK)
    # Every fifth has no depth.
    found = features(random_descriptors(50, 1)), np.arange(50, dtype=np.int32)
    monkeypatch.setattr(type(snapshot.reader), "features", lambda *_: found)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK, of="words")
    for handle, rgb in zip(handles(viewer), (DARK.overlay_from, DARK.overlay_to), strict=True):
        assert len(handle.points) == 40 and (np.asarray(handle.colors) == rgb).all()


def test_without_a_link_or_a_way_nothing_is_shown(viewer: Any, snapshot: Snapshot) -> None:
    graph, layer = PlacedGraph.of(snapshot), OverlayLayer(viewer.scene)
    assert layer.draw(snapshot, graph, PAIR, "poses", DARK)
    for pair, how in ((None, "poses"), (PAIR, None), ((1, 9999), "poses")):
        assert not layer.draw(snapshot, graph, pair, how, DARK)  # type: ignore[arg-type]
        assert handles(viewer) == [None, None]
