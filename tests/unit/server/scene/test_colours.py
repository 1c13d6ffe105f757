"""Nodes are coloured by what was asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from server.browse.snapshot import Snapshot
from server.scene.colours import DARK, LIGHT, node_colours, theme
from server.scene.placed import PlacedGraph
from server.schemas.scene import Colouring
from tests.unit.server.scene.placing import first


def test_memory_shows_the_three_tiers(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    for look in (DARK, LIGHT):
        colours = node_colours(graph, "memory", look)
        by_tier = {tier: {tuple(row) for row in colours[graph.tiers == tier].tolist()} for tier in range(3)}
        assert by_tier == {0: {look.stm}, 1: {look.wm}, 2: {look.ltm}}


def test_sessions_differ_and_one_session_is_one_colour(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    two = replace(graph, map_ids=np.where(graph.ids < 10, 3, 7))
    colours = [tuple(row) for row in node_colours(two, "session", DARK).tolist()]
    assert len(set(colours)) == 2
    assert len(set(colours[:9])) == 1


@pytest.mark.parametrize("how", ["time", "weight"])
def test_the_first_and_the_last_of_a_scale_differ(snapshot: Snapshot, how: Colouring) -> None:
    graph = PlacedGraph.of(snapshot)
    colours = node_colours(graph, how, DARK).astype(int)
    values = np.arange(len(graph)) if how == "time" else graph.weights
    least, most = colours[values.argmin()], colours[values.argmax()]
    assert np.abs(least - most).max() > 100
    assert (colours[values == values.max()] == most).all()


@pytest.mark.parametrize("how", ["memory", "session", "time", "weight"])
def test_no_nodes_have_no_colours(snapshot: Snapshot, how: Colouring) -> None:
    empty = first(PlacedGraph.of(snapshot), 0)
    assert node_colours(empty, how, theme(True)).shape == (0, 3)
