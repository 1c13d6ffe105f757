"""All poses at once: those of an optimisation of one's own are kept, and a map is turned as it is."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from slam.database import Faults, MapReader, MapWriter
from slam.edit.placements import optimising, turning
from slam.edit.wishes import Optimisation, Turn
from slam.errors import DamagedRowError, DecisionError
from slam.geometry import Array, Pose, from_euler_rpy, se3_exp
from slam.graph import PoseGraph, optimize
from slam.graph.course import course
from slam.params import Params
from slam.review import Review
from slam.types import Link, LinkType, Manner
from tests.graphs import circles, stacked, write_map

NODES = 30
MANNER = Manner(root=4, without=(LinkType.GLOBAL_CLOSURE,), kernel="Cauchy", start="odometry")
Opened = tuple[Review, MapReader, MapWriter]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = write_map(tmp_path_factory.mktemp("made") / "map.db", circles(NODES, loops=3))
    with MapWriter.open(path) as writer:
        poses = optimize(PoseGraph.from_reader(MapReader(path)), Params()).poses
        writer.save_poses(poses, poses[NODES])
    return path


@pytest.fixture
def opened(made: Path, tmp_path: Path) -> Iterator[Opened]:
    with MapWriter.open(Path(shutil.copy(made, tmp_path / "map.db"))) as writer:
        yield reviewed(writer)


def reviewed(writer: MapWriter) -> Opened:
    """As after a restart."""
    reader = MapReader(writer.path)
    return Review(PoseGraph.from_reader(reader), writer, reader, Params()), reader, writer


def keep(review: Review, manner: Manner = MANNER, step: int | None = None) -> Array:
    """The poses (N, 4, 4) that keeping those of an optimisation leads to."""
    wanted = Optimisation(manner=manner, step=step, author="ann")
    review.change([optimising(review.graph, review.params, wanted)])
    return stacked(review.graph.poses)


def turn(opened: Opened, **wanted: object) -> Pose:
    """Where turning the map took it, T_new_old."""
    review, reader, _ = opened
    review.change([turning(review.graph, review.params, reader, Turn(**wanted))])  # type: ignore[arg-type]
    placement = reader.journal()[-1].placement
    assert placement is not None and placement.T_new_old is not None
    return placement.T_new_old


def test_what_is_kept_is_what_was_tried_and_links_stay(opened: Opened) -> None:
    review, reader, _ = opened
    tried, links = course(review.graph, review.params, MANNER), len(reader.links())
    for step, (poses, _) in list(enumerate(tried.steps))[:: len(tried.steps) - 1]:
        kept = keep(review, step=step)
        np.testing.assert_array_equal(kept, np.array([poses[i] for i in sorted(review.graph.poses)]))
        assert np.allclose(stacked(reader.poses()), kept, atol=1e-5)
        review.undo()
    assert len(reader.links()) == links and reader.grid() is None
    entry = reader.journal()[0]
    assert (entry.action, entry.author, entry.from_id) == ("optimise", "ann", 4)
    assert entry.note == "root 4; without GlobalClosure; kernel Cauchy; from odometry; iteration 0"
    assert entry.moved > 0 and entry.chi2_after is not None and entry.chi2_before is not None
    assert entry.placement is not None and entry.placement.manner == MANNER
    with pytest.raises(DecisionError, match="no iteration 999: the optimisation ends with iteration"):
        keep(review, step=999)
    with pytest.raises(DecisionError, match="no node 99 to hold fixed"):
        keep(review, Manner(root=99))


def test_where_the_poses_before_are_not_kept_it_is_done_anew(opened: Opened) -> None:
    review, reader, writer = opened
    start, kept = stacked(review.graph.poses), keep(review)
    assert np.abs(kept - start).max() > 0.01
    away = se3_exp(np.array([1.0, 0, 0, 0, 0, 0]))
    writer.save_poses({i: away @ T for i, T in reader.poses().items()}, None)
    again, *_ = reviewed(writer)
    assert np.allclose(stacked(again.undo() and again.graph.poses), away @ start, atol=0.02), "as the parameters say"
    writer.save_poses({i: away @ T for i, T in reader.poses().items()}, None)
    again, *_ = reviewed(writer)
    again.redo()
    relative = [np.linalg.inv(poses[3]) @ poses for poses in (kept, stacked(again.graph.poses))]
    assert np.allclose(*relative, atol=1e-3), "in the same manner"


def test_a_map_is_turned_with_the_robot_in_it(opened: Opened) -> None:
    review, reader, writer = opened
    before, last = stacked(review.graph.poses), reader.last_pose()
    T = turn(opened, yaw_rad=np.pi / 2)
    assert np.allclose(T, from_euler_rpy(np.array([0, 0, np.pi / 2]), np.zeros(3)))
    assert np.allclose(stacked(review.graph.poses), T @ before)
    found = reader.last_pose()
    assert last is not None and found is not None and np.allclose(found, T @ last, atol=1e-5)
    assert reader.journal()[-1].note == "by 90°" and reader.journal()[-1].chi2_after == pytest.approx(
        reader.journal()[-1].chi2_before
    )
    writer.save_poses({i: T @ pose for i, pose in reader.poses().items()}, None)
    again, *_ = reviewed(writer)
    again.undo()
    assert np.allclose(stacked(again.graph.poses), T @ before, atol=1e-4), "back by as much, where others turned it on"


def test_a_map_is_laid_over_the_truth(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    review, reader, _ = opened
    table, T = reader.nodes(), se3_exp(np.array([2.0, -1.0, 0.5, 0.3, 0.1, 1.0]))
    table.T_world[:] = T @ stacked(review.graph.poses)
    monkeypatch.setattr(MapReader, "nodes", lambda *_: table)
    assert np.allclose(turn(opened, to="truth"), T, atol=1e-5)
    assert np.allclose(stacked(review.graph.poses), table.T_world, atol=1e-5)
    review.undo()
    review.graph.add_constraint(Link(5, 5, LinkType.GRAVITY, np.eye(4), np.eye(6)))
    review.params = review.params.changed({"Optimizer/GravitySigma": 0.1})
    level = turn(opened, to="truth")
    assert np.allclose(level[2, :2], 0) and np.allclose(level[:3, 3], T[:3, 3], atol=1.0), "gravity holds it level"


def test_what_would_not_last_or_has_no_base_is_refused(opened: Opened) -> None:
    review, reader, writer = opened
    for to, what in (("truth", "ground truth"), ("gps", "GPS")):
        with pytest.raises(DecisionError, match=f"0 nodes of the map know where they are by .*{what}"):
            turn(opened, to=to)
    run = Review(review.graph, writer, reader, review.params, nodes_stay=True)
    with pytest.raises(DecisionError, match=r"optimise the map would not last: .* Stop the run first"):
        keep(run)
    review.graph.add_constraint(Link(5, 5, LinkType.POSE_PRIOR, np.eye(4), np.eye(6)))
    review.params = review.params.changed({"Optimizer/PriorsIgnored": False})
    with pytest.raises(DecisionError, match="1 priors count in this map"):
        turn(opened, yaw_rad=1.0)
    assert not reader.journal()


@pytest.mark.parametrize(
    "change",
    ["root = -3", "without = '77'", "without = 'x'", "solver = 9", "kernel = 'none of it'", "T_new_old = x'00'"],
)
def test_placements_that_make_no_sense_are_named(opened: Opened, change: str) -> None:
    review, reader, _ = opened
    keep(review)
    with closing(sqlite3.connect(reader.path)) as file, file:
        file.execute(f"UPDATE deck_placement SET {change}")
    with pytest.raises(DamagedRowError, match="deck_placement"):
        reader.journal()
    faults = Faults()
    assert reader.journal(faults)[0].placement is None
    assert [fault.table for fault in faults] == ["deck_placement"]
