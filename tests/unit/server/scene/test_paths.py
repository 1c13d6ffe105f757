"""Odometry begins where the map does, truth lies on the map."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from server.browse.snapshot import Snapshot
from server.scene.colours import DARK
from server.scene.paths import PathLayer, odometry_path, true_path
from server.scene.placed import PlacedGraph
from slam.geometry import se3_exp
from tests.unit.server.scene.placing import first
from tests.unit.server.scene.room_map import NODES


def test_odometry_begins_at_the_first_node_of_each_session_and_drifts_from_there(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    path = odometry_path(graph, 0.05)
    drift = np.array([0.02, 0.0, 0.0])
    np.testing.assert_allclose(path[0, 0], graph.positions[0], atol=1e-5)
    assert np.linalg.norm(path[-1, 1] - graph.positions[-1]) > 10 * np.linalg.norm(drift)
    two = replace(graph, map_ids=np.where(graph.ids < 10, 0, 1))
    starts = odometry_path(two, 0.05)[:, 0]
    assert np.linalg.norm(starts - graph.positions[9], axis=1).min() < 1e-5


def test_truth_from_anywhere_is_laid_over_the_map(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    moved = se3_exp(np.array([5.0, -3.0, 1.0, 0.3, -0.2, 2.0]))
    path = true_path(replace(graph, T_world=np.asarray(moved @ graph.T_world)))
    assert len(path) == NODES - 1
    np.testing.assert_allclose(path[:, 0], graph.positions[:-1], atol=1e-5)


def test_what_is_not_known_is_not_drawn(snapshot: Snapshot, viewer: Any) -> None:
    graph = PlacedGraph.of(snapshot)
    unknown = np.full_like(graph.T_map, np.nan)
    blind = replace(graph, T_world=unknown, T_odom=unknown)
    assert true_path(blind).shape == odometry_path(blind, 0.1).shape == (0, 2, 3)
    PathLayer(viewer.scene).draw(blind, 0.1, DARK, odometry=True, truth=True)
    assert viewer.scene.get_handle_by_name("/paths/odometry/0") is None
    assert len(true_path(first(graph, 1))) == len(true_path(first(graph, 0))) == 0


def test_both_paths_are_switched_on_their_own(snapshot: Snapshot, viewer: Any) -> None:
    PathLayer(viewer.scene).draw(PlacedGraph.of(snapshot), 0.1, DARK, odometry=True, truth=False)
    assert viewer.scene.get_handle_by_name("/paths/odometry/0").visible
    assert viewer.scene.get_handle_by_name("/paths/truth/0") is None
