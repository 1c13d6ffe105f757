"""The floor plan that is made anew after decisions, node by node."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from slam.database import MapReader, MapWriter
from slam.geometry import make
from slam.graph.graph import PoseGraph
from slam.maps.grid_rebuild import GridRebuild
from slam.params import Params
from slam.types import OccupancyGrid
from tests.unit.server.loop_map import write_loop_map

PARAMS = Params()
several = settings(deadline=None, max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture
def writer(tmp_path: Path) -> Iterator[MapWriter]:
    write_loop_map(tmp_path / "map.db")
    with MapWriter.open(tmp_path / "map.db") as opened:
        yield opened


def rebuild(writer: MapWriter) -> tuple[GridRebuild, PoseGraph]:
    reader = MapReader(writer.path)
    graph = PoseGraph.from_reader(reader)
    return GridRebuild(reader, writer, graph, PARAMS), graph


def moved(graph: PoseGraph, seed: int) -> None:
    """Each node goes somewhere else."""
    shifts = np.random.default_rng(seed).uniform(-1, 1, (len(graph.poses), 3)) * (1, 1, 0)
    graph.poses = {i: make(np.eye(3), t) @ T for (i, T), t in zip(graph.poses.items(), shifts, strict=True)}


def stored(writer: MapWriter) -> OccupancyGrid:
    grid = MapReader(writer.path).grid()
    assert grid is not None
    return grid


def same(a: OccupancyGrid, b: OccupancyGrid) -> bool:
    return (a.x_min, a.y_min, a.cell_size) == (b.x_min, b.y_min, b.cell_size) and np.array_equal(a.cells, b.cells)


@several
@given(st.lists(st.integers(0, 40), max_size=4), st.integers(0, 100))
def test_left_off_anywhere_it_ends_as_if_made_at_once(writer: MapWriter, left_off: list[int], seed: int) -> None:
    parts, graph = rebuild(writer)
    for k, steps in enumerate([*left_off, 10_000]):
        moved(graph, seed + k)
        parts.poses_changed()
        while steps and parts.is_due:
            parts.step()
            steps -= 1
    assert not parts.is_due
    found, (whole, of_whole) = stored(writer), rebuild(writer)
    of_whole.poses = graph.poses
    assert whole.carry_out()
    assert same(found, stored(writer))


def test_one_that_a_decision_removed_is_stored_again_though_nothing_moved(writer: MapWriter) -> None:
    parts, _ = rebuild(writer)
    assert parts.carry_out()
    before = stored(writer)
    writer.save_grid(None)
    assert parts.carry_out()
    assert same(before, stored(writer))


def test_a_damaged_local_grid_is_left_out_and_a_map_without_any_has_no_plan(writer: MapWriter) -> None:
    damage(writer.path, "update Data set obstacle_cells = x'0102030405060708' where id = 2")
    parts, graph = rebuild(writer)
    assert parts.carry_out()
    found = stored(writer)
    without, of_without = rebuild(writer)
    of_without.poses = {i: T for i, T in graph.poses.items() if i != 2}
    assert without.carry_out() and same(found, stored(writer))

    writer.save_grid(None)
    damage(writer.path, "update Data set cell_size = 0")
    bare, _ = rebuild(writer)
    assert not bare.carry_out() and MapReader(writer.path).grid() is None


def test_a_cell_size_that_no_parameter_may_have_does_not_end_it(writer: MapWriter) -> None:
    """What else was decided stays, and so does the process that decides."""
    damage(writer.path, "update Data set cell_size = 2.5")
    parts, _ = rebuild(writer)
    assert parts.carry_out()


def damage(path: Path, statement: str) -> None:
    connection = sqlite3.connect(path)
    with connection:
        connection.execute(statement)
    connection.close()
