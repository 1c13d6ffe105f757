"""Local grids made anew of stored depth: the same as the engine made, others with other parameters, and one undo."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.camera import Camera
from slam.database import MapReader, MapWriter
from slam.edit.grids import merged, regrid
from slam.edit.wishes import Regrid
from slam.effect import Effect
from slam.errors import DecisionError, ParameterError
from slam.graph import PoseGraph
from slam.params import Params
from slam.review import Review
from slam.types import LocalGrid
from tests.graphs import circles, write_map

NODES = 12
WITHOUT_DEPTH = 7
Opened = tuple[Review, MapReader]


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Opened]:
    """A map whose nodes see a wall, each a little farther away; one has no depth."""
    path = write_map(tmp_path / "map.db", circles(NODES, loops=0))
    with closing(sqlite3.connect(path)) as file:
        for node_id in range(1, NODES + 1):
            wall = cv2.imencode(".png", np.full((60, 80), 1500 + 100 * node_id, np.uint16))[1]
            if node_id != WITHOUT_DEPTH:
                file.execute("UPDATE Data SET depth = ? WHERE id = ?", (bytes(wall), node_id))
        file.commit()
    with MapWriter.open(path) as writer:
        yield reviewed(writer)


def reviewed(writer: MapWriter) -> Opened:
    reader = MapReader(writer.path)
    return Review(PoseGraph.from_reader(reader), writer, reader, Params()), reader


def carry_out(opened: Opened, wanted: Regrid) -> tuple[Effect | None, list[str]]:
    job, said = regrid(*opened, wanted, "ann"), list[str]()
    while True:
        try:
            said.append(next(job).text)
        except StopIteration as end:
            return end.value, said


def farthest(reader: MapReader, node_id: int) -> float:
    grid = reader.local_grid(node_id)
    return 0.0 if grid is None else float(grid.obstacles[:, 0].max(initial=0.0))


def test_grids_that_are_absent_are_made_and_those_without_depth_are_named(opened: Opened) -> None:
    _, reader = opened
    assert not len(reader.nodes_with_grid())
    effect, said = carry_out(opened, Regrid())
    assert effect is not None and effect.moved == 0 and len(effect.entries) == 1
    assert sorted(set(range(1, NODES + 1)) - set(reader.nodes_with_grid().tolist())) == [WITHOUT_DEPTH]
    assert any(f"node {WITHOUT_DEPTH}: stays as it is" in text and "depth" in text for text in said)
    assert said[-1] == f"{NODES - 1} of {NODES} local grids made anew"
    assert farthest(reader, 1) == pytest.approx(1.6, abs=0.1) and farthest(reader, 5) == pytest.approx(2.0, abs=0.1)
    (entry,) = reader.journal()
    assert (entry.action, entry.author, entry.note) == ("regrid", "ann", f"{NODES - 1} nodes")


def test_only_those_chosen_with_other_parameters_and_undo_puts_them_back(opened: Opened) -> None:
    review, reader = opened
    carry_out(opened, Regrid())
    carry_out(opened, Regrid(changes={"Grid/RangeMax": 1.0}, first=3, last=4))
    assert [farthest(reader, i) > 0 for i in (2, 3, 4, 5)] == [True, False, False, True]
    review.undo()
    assert farthest(reader, 3) == pytest.approx(1.8, abs=0.1)
    review.redo()
    assert farthest(reader, 3) == 0
    assert reader.journal()[1].note == "2 nodes: Grid/RangeMax 1.0"


def test_a_cell_size_is_that_of_all_grids_and_of_the_map(opened: Opened) -> None:
    review, reader = opened
    carry_out(opened, Regrid())
    with pytest.raises(DecisionError, match=r"Grid/CellSize 0\.1: 9 nodes, 3 among them, would keep cells of 0\.05 m"):
        carry_out(opened, Regrid(changes={"Grid/CellSize": 0.1}, last=2))
    carry_out(opened, Regrid(changes={"Grid/CellSize": 0.1}))
    grid = reader.local_grid(1)
    assert grid is not None and grid.cell_size == 0.1
    assert review.params.Grid.CellSize == 0.1 and reader.parameters()["Grid/CellSize"] == "0.1"
    review.undo()
    assert reader.parameters()["Grid/CellSize"] == "0.05"


@pytest.mark.parametrize(
    ("wanted", "why"),
    [
        (Regrid(first=90), "no node is of these ids"),
        (Regrid(session=4), "no node is of session 4"),
        (Regrid(changes={"Kp/MaxFeatures": 100}), "Kp/MaxFeatures: only parameters of the group Grid/"),
        (Regrid(changes={"Grid/RangeMax": -1.0}), "Grid/RangeMax"),
    ],
)
def test_what_can_not_be_is_refused(opened: Opened, wanted: Regrid, why: str) -> None:
    with pytest.raises((DecisionError, ParameterError), match=why):
        carry_out(opened, wanted)
    assert not opened[1].journal()


def test_a_job_that_is_left_off_changes_nothing(opened: Opened) -> None:
    job = regrid(*opened, Regrid())
    next(job)
    job.close()
    assert not len(opened[1].nodes_with_grid()) and not opened[1].journal()


cells = st.lists(st.tuples(st.integers(-20, 20), st.integers(-20, 20)), max_size=30, unique=True)


@settings(max_examples=50)
@given(st.lists(st.tuples(cells, cells, cells), min_size=2, max_size=3))
def test_what_several_cameras_saw_is_one_grid_in_which_obstacles_hold(
    seen: list[tuple[list[tuple[int, int]], ...]],
) -> None:
    grids = [LocalGrid(*(centres(kind) for kind in one), 0.05) for one in seen]
    whole = merged(grids)
    all_of = [{cell for one in seen for cell in one[kind]} for kind in range(3)]
    found = [places(kind) for kind in (whole.ground, whole.obstacles, whole.empty)]
    assert found[1] == all_of[1] and found[0] == all_of[0] - all_of[1]
    assert found[2] == all_of[2] - all_of[1] - all_of[0]


def centres(indices: list[tuple[int, int]]) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    return ((np.array(indices, np.float64).reshape(-1, 2) + 0.5) * 0.05).astype(np.float32)


def places(kind: np.ndarray[tuple[int, int], np.dtype[np.float32]]) -> set[tuple[int, int]]:
    return {(int(x), int(y)) for x, y in np.floor(kind / 0.05).tolist()}


@pytest.mark.parametrize("scale", [0.25, 0.5, 2.0])
def test_a_camera_at_another_size_sees_the_same(scale: float) -> None:
    camera = Camera(320, 240, 262.5, 260.0, 159.5, 119.5)
    other = camera.at_size(round(320 * scale), round(240 * scale))
    points = np.array([[0.3, -0.2, 2.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose((camera.project(points) + 0.5) * scale, other.project(points) + 0.5)
    assert camera.at_size(320, 240) is camera


def test_grids_of_a_map_that_is_being_made_stay(opened: Opened) -> None:
    review, reader = opened
    mapping = Review(review.graph, review._writer, reader, Params(), nodes_stay=True)
    with pytest.raises(DecisionError, match="stop the run first"):
        carry_out((mapping, reader), Regrid())
