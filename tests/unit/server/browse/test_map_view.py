"""A view notices what a writer commits, and reads nothing twice while nothing changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from server.browse.map_view import MapView
from server.catalog import MapFile
from slam.database import MapWriter
from slam.types import OccupancyGrid
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


def test_a_floor_plan_that_was_made_anew_is_no_other_graph(path: Path) -> None:
    write_loop_map(path)
    view = view_of(path)
    before = view.snapshot()
    with MapWriter.open(path) as writer:
        writer.save_grid(OccupancyGrid(np.zeros((3, 4), np.int8), 0.0, 0.0, 0.05))
        view.grid_written()
        assert view.snapshot() is before and before.reader.grid() is not None
        # One that was told of together with a decision does not hide it.
        revision = view.touch()
        writer.save_grid(None)
        view.grid_written()
        assert view.snapshot().revision == revision


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
