"""What is selected stands out, and what the map does not have does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from server.browse.snapshot import Pair, Snapshot
from server.scene.colours import DARK
from server.scene.highlight import Highlight, rings, small
from server.scene.measure import Measure
from server.scene.placed import PlacedGraph
from slam.camera import T_BASE_OPTICAL
from slam.database import MapReader
from tests.unit.server.scene.conftest import Sent
from tests.unit.server.scene.room_map import write_room_map


class Selecting:
    """A highlight on one map."""

    def __init__(self, viewer: Any, snapshot: Snapshot) -> None:
        self._viewer, self._snapshot = viewer, snapshot
        self._highlight, self._graph = Highlight(viewer.scene), PlacedGraph.of(snapshot)

    def select(self, node: int | None, link: Pair | None = None) -> None:
        measure = Measure.of(self._graph.positions)
        self._highlight.draw(self._snapshot, self._graph, node, link, measure, DARK)

    def shown(self, name: str) -> Any:
        return self._viewer.scene.get_handle_by_name(f"/selected/{name}")


@pytest.fixture
def selecting(viewer: Any, snapshot: Snapshot) -> Selecting:
    return Selecting(viewer, snapshot)


def test_a_node_gets_a_ring_its_id_and_its_view(selecting: Selecting, snapshot: Snapshot) -> None:
    selecting.select(7)
    ring = selecting.shown("rings/0").points.reshape(-1, 3)
    np.testing.assert_allclose(ring.mean(axis=0), snapshot.poses[7][:3, 3], atol=1e-3)
    assert selecting.shown("label").text == "7"
    np.testing.assert_allclose(selecting.shown("view").position, (snapshot.poses[7] @ T_BASE_OPTICAL)[:3, 3])
    assert selecting.shown("arc/0") is None


def test_a_link_gets_rings_an_arc_and_both_ids(selecting: Selecting, snapshot: Snapshot) -> None:
    selecting.select(None, (13, 1))
    assert selecting.shown("label").text == "13 → 1"
    joined = selecting.shown("arc/0").points
    np.testing.assert_allclose(joined[0, 0], snapshot.poses[13][:3, 3], atol=1e-6)
    np.testing.assert_allclose(joined[-1, 1], snapshot.poses[1][:3, 3], atol=1e-6)
    np.testing.assert_array_equal(joined[:-1, 1], joined[1:, 0])
    assert selecting.shown("view") is None


def test_a_pair_that_is_no_link_is_dashed(selecting: Selecting) -> None:
    selecting.select(None, (18, 2))
    dashes = selecting.shown("arc/0").points
    assert (np.linalg.norm(dashes[:-1, 1] - dashes[1:, 0], axis=1) > 1e-3).all()


@pytest.mark.parametrize(("node", "link"), [(None, None), (999, None), (None, (7, 999))])
def test_nothing_and_what_is_not_in_the_map_is_not_shown(
    selecting: Selecting, node: int | None, link: Pair | None
) -> None:
    selecting.select(7)
    selecting.select(node, link)
    assert selecting.shown("view") is None
    assert selecting.shown("rings/0") is None
    assert not selecting.shown("label").visible


def test_an_image_is_sent_once_for_a_selection(selecting: Selecting, sent: Sent) -> None:
    selecting.select(7)
    sent.take()
    selecting.select(7)
    assert sent.take() == []
    selecting.select(8)
    assert ("CameraFrustum", "/selected/view") in sent.take()


def test_a_node_without_an_image_gets_its_ring(viewer: Any, tmp_path: Path) -> None:
    snapshot = Snapshot(MapReader(write_room_map(tmp_path / "bare.db", 3, images=False)), 1, {})
    selecting = Selecting(viewer, snapshot)
    selecting.select(2)
    selecting.select(2)
    assert selecting.shown("rings/0") is not None
    assert selecting.shown("view") is None


def test_a_thumbnail_keeps_its_proportions_and_is_red_first() -> None:
    image = np.zeros((120, 90, 3), dtype=np.uint8)
    image[..., 2] = 200
    reduced = small(image)
    assert reduced.shape == (480, 360, 3)
    assert tuple(reduced[0, 0]) == (200, 0, 0)


def test_rings_are_level_circles() -> None:
    circle = rings(np.array([[1.0, 2.0, 3.0]]), 0.5).reshape(-1, 3)
    np.testing.assert_allclose(np.linalg.norm(circle - (1.0, 2.0, 3.0), axis=1), 0.5)
    assert set(circle[:, 2]) == {3.0}
