"""What the 3D view shows of a moment: poses and grid as they were."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from server.browse.grid_then import GridThen
from server.browse.map_view import MapView
from server.browse.poses_then import PosesThen, graph_then
from server.catalog import MapFile
from slam.database import MapReader
from slam.errors import OptimizationError
from slam.geometry import Pose, between, make, translation_norm
from slam.maps.global_grid import GlobalGrid
from slam.params import Params
from slam.types import LocalGrid, OccupancyGrid
from tests.tours import mapped
from tests.unit.server.loop_map import ACCEPTED, NODES, odometry_pose, write_loop_map

COUNT = 40


def view_of(path: Path) -> MapView:
    return MapView(MapFile("map", "map", path))


@pytest.fixture(scope="module")
def toured(tmp_path_factory: pytest.TempPathFactory) -> MapView:
    return view_of(Path(shutil.copy(mapped(0).path, tmp_path_factory.mktemp("past") / "tour.db")))


def test_the_graph_of_then_gives_back_where_the_engine_took_the_robot_to_be(toured: MapView) -> None:
    timeline = toured.timeline()
    poses = PosesThen(timeline)
    assert len(timeline.turns) > 0
    moved = 0.0
    for move in timeline.moves:
        then = poses.poses(move.id)
        assert max(then) == move.id
        assert move.T_map_base is not None
        assert translation_norm(between(move.T_map_base, then[move.id])) < 1e-4
        moved = max(moved, translation_norm(between(then[move.id], timeline.snapshot.poses[move.id])))
    assert moved > 1e-3, "loops have moved what came before them"
    last = poses.poses(timeline.ids[-1])
    now = timeline.snapshot.poses
    assert max(translation_norm(between(last[i], now[i])) for i in last) < 1e-4


def test_poses_depend_on_the_moment_alone(toured: MapView) -> None:
    timeline = toured.timeline()
    some = [*timeline.turns, timeline.ids[-1], timeline.ids[len(timeline.ids) // 2]]
    forth, back = PosesThen(timeline), PosesThen(timeline)
    found = {at: forth.poses(at) for at in sorted(some)}
    for at in sorted(some, reverse=True):
        again = back.poses(at)
        assert again.keys() == found[at].keys()
        assert all(np.allclose(again[i], found[at][i], atol=1e-6) for i in again)


def test_before_any_loop_the_path_is_that_of_odometry(tmp_path: Path) -> None:
    write_loop_map(tmp_path / "map.db")
    timeline = view_of(tmp_path / "map.db").timeline()
    assert timeline.turns == [newer for newer, _ in ACCEPTED]
    then = PosesThen(timeline).poses(NODES - 2)
    for node_id in range(1, NODES - 1):
        step = between(odometry_pose(1), odometry_pose(node_id))
        np.testing.assert_allclose(between(then[1], then[node_id]), step, atol=1e-6)
    assert set(graph_then(timeline, NODES - 1).links) >= {(older, newer) for newer, older in ACCEPTED[:1]}
    assert ACCEPTED[1][::-1] not in graph_then(timeline, NODES - 1).links


def test_a_grid_of_then_comes_with_the_poses_of_then(toured: MapView) -> None:
    past, at = toured.past(), toured.timeline().ids[len(toured.timeline().ids) // 2]
    then = past.at(at, with_grid=True, patient=True)
    while not then.is_complete:
        then = past.at(at, with_grid=True, patient=True)
    assert then.poses is not None
    assert then.grid is not None
    grid = GlobalGrid(toured.snapshot().params)
    for node_id in (i for i in sorted(then.poses) if i <= at):
        local = toured.reader.local_grid(node_id)
        if local is not None:
            grid.add(node_id, local, then.poses[node_id])
    expected = grid.occupancy()
    assert expected is not None
    np.testing.assert_array_equal(then.grid.cells, expected.cells)
    assert past.at(at, with_grid=False, patient=True).grid is None


def test_what_takes_long_waits_for_who_stays(toured: MapView, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("server.browse.poses_then._QUICK_S", 0.0)
    toured.touch()
    past, at = toured.past(), toured.timeline().ids[-1]
    passing = past.at(at, with_grid=False, patient=False)
    assert passing.poses is None
    assert not passing.is_complete
    assert past.at(at, with_grid=False, patient=True).is_complete
    assert past.at(at, with_grid=False, patient=False).poses is not None, "known by now"


def test_a_graph_that_has_no_minimum_is_shown_as_it_is_now(toured: MapView, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OptimizationError("no way down")

    monkeypatch.setattr("server.browse.poses_then.optimize", refuse)
    toured.touch()
    then = toured.past().at(toured.timeline().ids[-1], with_grid=False, patient=True)
    assert (then.poses, then.is_complete, then.failure) == (None, True, "no way down")


class Grids:
    """Local grids of a made-up walk."""

    def local_grid(self, node_id: int) -> LocalGrid | None:
        rng = np.random.default_rng(node_id)
        cells = rng.uniform(-1.5, 1.5, (60, 2)).astype(np.float32)
        return None if node_id % 7 == 0 else LocalGrid(cells[:40], cells[40:], cells[:0], 0.1)


def walked(spread: float = 0.2) -> dict[int, Pose]:
    return {i: make(np.eye(3), np.array([spread * i, 0.3 * np.sin(i), 0.0])) for i in range(1, COUNT + 1)}


def scratch(count: int) -> OccupancyGrid | None:
    grid = GlobalGrid(Params().changed({"Grid/CellSize": 0.1}))
    for i, T in list(walked().items())[:count]:
        local = Grids().local_grid(i)
        if local is not None:
            grid.add(i, local, T)
    return grid.occupancy()


@settings(max_examples=15, deadline=None)
@given(st.lists(st.integers(0, COUNT), min_size=1, max_size=12))
def test_however_one_comes_to_a_moment_its_grid_is_the_same(counts: list[int]) -> None:
    grids, poses, order = GridThen(cast("MapReader", Grids()), Params()), walked(), list(walked())
    for count in counts:
        found, complete = grids.at("now", order, count, poses, 60.0)
        expected = scratch(count)
        assert complete
        if expected is None:
            assert found is None
            continue
        assert found is not None
        np.testing.assert_array_equal(found.cells, expected.cells)
        assert (found.x_min, found.y_min) == pytest.approx((expected.x_min, expected.y_min))


def test_copies_to_go_back_to_have_a_bound_and_nonsense_has_no_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("server.browse.grid_then._COPIED_CELLS", 1)
    grids, poses, order = GridThen(cast("MapReader", Grids()), Params()), walked(), list(walked())
    poses[3] = make(np.eye(3), np.array([1e9, 0.0, 0.0]))
    grids.at("now", order, COUNT, poses, 60.0)
    course = grids._courses["now"]
    assert len(course.copies) <= 1
    assert course.grid.size < 1_000_000
    found, _ = grids.at("now", order, 2, poses, 60.0)
    assert found is not None
    np.testing.assert_array_equal(found.cells, cast("OccupancyGrid", scratch(2)).cells)
