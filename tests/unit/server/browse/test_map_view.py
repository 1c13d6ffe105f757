"""A view notices what a writer commits, and reads nothing twice while nothing changes."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.browse.map_view import MapView
from server.catalog import MapFile
from tests.unit.server.loop_map import NODES, add_node, write_loop_map


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "map.db"


def view_of(path: Path) -> MapView:
    return MapView(MapFile("map", "map", path))


def test_the_same_snapshot_as_long_as_nothing_changes(path: Path) -> None:
    write_loop_map(path)
    view = view_of(path)
    assert view.snapshot() is view.snapshot()
    first = view.snapshot()
    assert view.touch() == first.revision + 1
    assert view.snapshot().revision == first.revision + 1


def test_nodes_of_a_writer_at_work_are_seen_with_their_tiers(path: Path) -> None:
    writer = write_loop_map(path, close=False)
    assert writer is not None
    with writer:
        view = view_of(path)
        before = view.snapshot()
        assert len(before.nodes) == NODES
        names = view.statistics.names()
        add_node(writer, NODES + 1)
        after = view.snapshot()
        assert after.revision > before.revision
        assert after.nodes.ids[-1] == NODES + 1
        assert after.tiers[NODES + 1] == "stm" and after.tiers[NODES - 5] == "ltm"
        assert view.statistics.columns(names[:1], NODES).ids == [NODES + 1]
        assert len(before.nodes) == NODES, "what was read stays as it was"
