"""The first view holds all of the map."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from server.scene.framing import FIELD_OF_VIEW, Framing, frame
from tests.unit.server.scene.placing import long_walk


def across(view: Framing, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where points are in the view: right and up, from -1 to 1 in a view of 5 by 4; points behind it are NaN."""
    forward = (view.look_at - view.position) / np.linalg.norm(view.look_at - view.position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    local = (points - view.position) @ np.column_stack([right, np.cross(right, forward), forward])
    depth = np.where(local[:, 2] > 0, local[:, 2], np.nan) * np.tan(FIELD_OF_VIEW / 2)
    return np.column_stack([local[:, 0] / depth / 1.25, local[:, 1] / depth])


@given(st.integers(1, 80), st.floats(0.05, 40.0), st.booleans())
def test_every_node_is_in_sight_from_above(count: int, scale: float, growing: bool) -> None:
    graph = long_walk(count)
    graph.T_map[:, :3, 3] *= scale
    view = frame(graph, np.zeros((0, 3)), growing=growing)
    places = across(view, graph.positions)
    assert (np.abs(places) <= 1.0).all()
    assert view.position[2] > graph.positions[:, 2].max()


def test_the_view_is_no_larger_than_it_must_be() -> None:
    graph = long_walk(80)
    places = across(frame(graph, np.zeros((0, 3))), graph.positions)
    assert np.abs(places).max() > 0.75


def test_what_was_seen_is_in_sight_too_but_for_stray_points() -> None:
    graph, rng = long_walk(5), np.random.default_rng(0)
    room = rng.uniform(-4, 4, (3000, 3)) * (1, 1, 0.3)
    stray = rng.uniform(-90, 90, (20, 3))
    view = frame(graph, np.vstack([room, stray]))
    assert np.mean(np.abs(across(view, room)) <= 1.0) > 0.97
    assert np.linalg.norm(view.position) < 25


def test_a_map_that_grows_gets_room() -> None:
    small, growing = (frame(long_walk(1), np.zeros((0, 3)), growing=grows) for grows in (False, True))
    assert growing.distance > 2 * small.distance
    assert growing.differs(small)
    assert not growing.differs(growing)


@pytest.mark.parametrize("yaw", [0.0, 1.0, 2.5, -2.0])
def test_a_camera_that_never_turned_is_looked_after_from_behind(yaw: float) -> None:
    graph = long_walk(1)
    c, s = np.cos(yaw), np.sin(yaw)
    graph.T_map[0, :2, :2] = [[c, -s], [s, c]]
    view = frame(graph, np.zeros((0, 3)))
    toward = (view.look_at - view.position)[:2]
    assert toward @ [c, s] > 0.8 * np.linalg.norm(toward)
