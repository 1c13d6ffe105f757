"""Chosen nodes cover the map, are few, and stay chosen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from server.browse.snapshot import Snapshot
from server.scene.choice import MOST, Choice
from server.scene.placed import PlacedGraph
from tests.unit.server.scene.placing import first, long_walk


def test_any_map_is_covered_by_few_clouds() -> None:
    graph, choice = long_walk(3000), Choice()
    choice.update(graph, graph.rows)
    assert MOST / 3 < len(choice.ids) <= MOST
    chosen = graph.positions[[graph.rows[i] for i in choice.ids]]
    gaps = np.linalg.norm(graph.positions[:, None] - chosen[None], axis=2).min(axis=1)
    assert gaps.max() < 0.1 * np.ptp(graph.positions, axis=0).max()


def test_a_node_that_was_chosen_stays_however_the_poses_move(snapshot: Snapshot) -> None:
    graph, choice = PlacedGraph.of(snapshot), Choice()
    choice.update(graph, range(1, 13))
    before = list(choice.ids)
    squeezed = graph.T_map.copy()
    squeezed[:, :3, 3] *= 0.01
    choice.update(replace(graph, T_map=squeezed), range(1, 25))
    assert choice.ids[: len(before)] == before


def test_the_second_look_at_the_same_place_adds_nothing(snapshot: Snapshot) -> None:
    graph, choice = PlacedGraph.of(snapshot), Choice()
    choice.update(graph, graph.rows)
    assert choice.ids == list(range(1, 13))


def test_only_usable_nodes_of_the_map_are_chosen(snapshot: Snapshot) -> None:
    graph, choice = PlacedGraph.of(snapshot), Choice()
    choice.update(graph, {3, 999})
    assert choice.ids == [3]
    choice.update(first(graph, 0), set())
    assert choice.ids == []
