"""Whatever people do to a map, undoing all of it is where they began and redoing all where they were, bit by bit."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import cast

import cv2
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.database import MapReader, MapWriter
from slam.database.blobs import pack_matrix
from slam.edit.covariances import weighing
from slam.edit.grids import regrid
from slam.edit.links import LinkEditor
from slam.edit.nodes import dropping, labelling
from slam.edit.placements import optimising, turning
from slam.edit.priors import placing
from slam.edit.wishes import CovarianceEdit, LinkEdit, Optimisation, PriorEdit, Regrid, Turn
from slam.effect import Effect
from slam.errors import DecisionError
from slam.geometry import between, se3_exp
from slam.graph import PoseGraph, optimize
from slam.params import Params, Value
from slam.review import Review
from slam.tools.parameters import taken
from slam.types import Candidate, Link, LinkType, Manner, Refusal
from tests.graphs import circles, loop, truth, write_map

NODES = 24
LOOPS = sorted(pair for pair in circles(NODES, loops=4).links if pair[1] - pair[0] > 1)
REFUSED = (20, 5)
UP = se3_exp(np.array([0.3, 0.0, 1.0, 0.1, 0.0, 0.2]))
#: All that decisions may change, but for the journal itself.
_STORED = (
    "SELECT from_id, to_id, type, information_matrix, transform, user_data FROM Link ORDER BY 1, 2, 3",
    "SELECT id, weight, label FROM Node ORDER BY id",
    "SELECT opt_ids, opt_poses FROM Admin",
    "SELECT * FROM deck_pose ORDER BY id",
    "SELECT parameters FROM Info",
    "SELECT id, ground_cells, obstacle_cells, empty_cells, cell_size, view_point_x, view_point_z FROM Data ORDER BY id",
)


@cache
def made() -> Path:
    """A map with priors ignored, gravity, a landmark, a loop that was refused, and a link with something attached."""
    path = Path(mkdtemp()) / "map.db"
    graph = circles(NODES, loops=4)
    graph.poses = optimize(graph, Params()).poses
    why = Refusal("RGBD/OptimizeMaxError", 5.0, 3.0, "too far")
    seen = loop(*REFUSED, truth(NODES), np.random.default_rng(1))
    candidate = Candidate(*REFUSED, LinkType.GLOBAL_CLOSURE, 0.3, 90, 12, seen.T_from_to, seen.information, why)
    write_map(path, graph, {NODES: (candidate,)})
    with MapWriter.open(path) as writer:
        ahead = se3_exp(np.array([1.0, 0, 0, 0, 0, 0]))
        writer.add_links([Link(i, i, LinkType.GRAVITY, np.eye(4), np.eye(6)) for i in (5, 12)])
        writer.add_links([Link(i, -1, LinkType.LANDMARK, ahead, np.eye(6)) for i in (5, 6)])
    with closing(sqlite3.connect(path)) as file:
        data = pack_matrix(np.arange(6, dtype=np.uint8)[None])
        file.execute("UPDATE Link SET user_data = ? WHERE from_id = ? AND to_id = ?", (data, *LOOPS[1]))
        # Another program may have rounded the way back otherwise, or have left it out.
        file.execute("DELETE FROM Link WHERE from_id = ? AND to_id = ?", LOOPS[2])
        # A wall two metres ahead; some grids are of other programs, with columns as these write them.
        wall = bytes(cv2.imencode(".png", np.full((60, 80), 2000, np.uint16))[1])
        file.execute("UPDATE Data SET depth = ?", (wall,))
        file.execute("UPDATE Data SET cell_size = 0.05, empty_cells = x'00000000', view_point_x = 1 WHERE id % 5 = 0")
        file.commit()
    return path


class Session:
    """A map that is open for decisions."""

    def __init__(self, writer: MapWriter) -> None:
        self.writer, self.reader = writer, MapReader(writer.path)
        params = taken(self.reader).params
        self.review = Review(PoseGraph.from_reader(self.reader), writer, self.reader, params)

    def again(self) -> Session:
        """The same after a restart."""
        return Session(self.writer)

    def stored(self) -> list[object]:
        """What the file holds."""
        with closing(sqlite3.connect(self.reader.path)) as file:
            return [file.execute(query).fetchall() for query in _STORED]

    def held(self) -> list[object]:
        """What is in memory; links as they are stored, for what was just made is not rounded yet."""
        graph = self.review.graph
        links = [*graph.links.values(), *graph.constraints.values()]
        rows = [(k.pair, k.type, np.asarray(k.T_from_to, np.float32).tobytes(), k.information.tobytes()) for k in links]
        poses = [(i, T.tobytes()) for i, T in sorted(graph.poses.items())]
        params, read = self.review.params, taken(self.reader).params
        set_ = [params.Optimizer.PriorsIgnored, params.Grid.CellSize]
        assert [read.Optimizer.PriorsIgnored, read.Grid.CellSize] == set_, "memory and file agree"
        return [sorted(rows), poses, set_]


def reject(at: Session, a: int, b: int) -> Effect:
    return at.review.reject(*LOOPS[a % len(LOOPS)]) if b % 2 else at.review.decide("reject", [*LOOPS[:3], REFUSED])


def approve(at: Session, a: int, b: int) -> Effect:
    return at.review.approve(*(REFUSED if b % 2 else LOOPS[a % len(LOOPS)]))


def link(at: Session, a: int, b: int) -> Effect | None:
    """Typed: a new link, or other numbers for the one that is there."""
    poses = at.review.graph.poses
    T = between(poses.get(a, np.eye(4)), poses.get(b, np.eye(4))) @ se3_exp(np.full(6, 0.01))
    edit = LinkEdit(action="edit", from_id=a, to_id=b, T_from_to=T, sigmas=np.full(6, 0.02), force=True)
    return LinkEditor(at.review, at.reader).carry_out(edit).effect


def drop(at: Session, a: int, b: int) -> Effect:
    return at.review.change(dropping(at.review.graph, at.reader, [a, b], "ann"))


def label(at: Session, a: int, b: int) -> Effect:
    return at.review.change(labelling(at.review.graph, at.reader, [a, b], "" if a == b else f"door {b % 3}", "ann"))


def prior(at: Session, a: int, b: int) -> Effect:
    where = None if b % 5 == 0 else UP @ at.review.graph.poses.get(a, np.eye(4))
    sigmas = None if where is None else np.array([0.05, 0.05, 0.05, *[0.02 * (b % 3)] * 3])
    wanted = PriorEdit(node_id=a, T_map_base=where, sigmas=sigmas, count=b % 2 == 0)
    return at.review.change([placing(at.review.graph, at.review.params, wanted)])


def weigh(at: Session, a: int, b: int) -> Effect:
    kinds = ((LinkType.NEIGHBOR,), (LinkType.GLOBAL_CLOSURE,), (LinkType.LANDMARK,))
    wanted = CovarianceEdit(sigmas=np.full(6, 0.01 * b), types=kinds[a % 3], first=min(a, b))
    return at.review.change(weighing(at.review.graph, wanted))


def optimise(at: Session, a: int, b: int) -> Effect:
    """Keep the poses of an optimisation on trial."""
    without = ((), (LinkType.GLOBAL_CLOSURE,), (LinkType.LANDMARK, LinkType.GRAVITY))[b % 3]
    manner = Manner(root=a, without=without, kernel="Cauchy" if b % 2 else None, start="odometry" if a % 2 else "map")
    wanted = Optimisation(manner=manner, step=b if b < 3 else None)
    return at.review.change([optimising(at.review.graph, at.review.params, wanted)])


def turn(at: Session, a: int, b: int) -> Effect:
    wanted = Turn(yaw_rad=0.1 * (a - b))
    return at.review.change([turning(at.review.graph, at.review.params, at.reader, wanted)])


def grids(at: Session, a: int, b: int) -> Effect | None:
    """Local grids made anew: of a stretch, or of all nodes with other cells."""
    changes: dict[str, Value] = {"Grid/CellSize": 0.1} if b % 3 == 0 else {"Grid/RangeMax": 0.5 * b}
    job = regrid(
        at.review, at.reader, Regrid(changes=changes, first=0 if b % 3 == 0 else a, last=a + 5 if b % 3 else 0)
    )
    while True:
        try:
            next(job)
        except StopIteration as end:
            return cast(Effect | None, end.value)


ACTS: dict[str, Callable[[Session, int, int], Effect | None]] = {
    **{act.__name__: act for act in (reject, approve, link, drop, label, prior, weigh, optimise, turn, grids)},
    "undo": lambda at, *_: at.review.undo(),
    "redo": lambda at, *_: at.review.redo(),
}
nodes = st.integers(1, NODES)
steps = st.lists(st.tuples(st.sampled_from(sorted(ACTS)), nodes, nodes, st.booleans()), min_size=1, max_size=7)


def carried_out(at: Session, act: str, a: int, b: int) -> bool:
    try:
        return ACTS[act](at, a, b) is not None
    except DecisionError:
        return False


def all_of(at: Session, act: str) -> int:
    count = 0
    while carried_out(at, act, 0, 0):
        count += 1
    return count


@settings(max_examples=10)
@given(steps, st.booleans())
def test_undoing_all_is_the_start_and_redoing_all_the_end(
    wanted: list[tuple[str, int, int, bool]], restart: bool
) -> None:
    with (
        TemporaryDirectory() as folder,
        MapWriter.open(Path(shutil.copy(made(), Path(folder) / "map.db"))) as writer,
    ):
        at = Session(writer)
        start = at.stored(), at.held()
        for act, a, b, between_two in wanted:
            at = at.again() if between_two else at
            before = at.stored(), at.held()
            if not carried_out(at, act, a, b):
                assert (at.stored(), at.held()) == before, "a refusal changes nothing"
        all_of(at, "redo")
        end = at.stored(), at.held()
        at = at.again() if restart else at
        undone = all_of(at, "undo")
        assert at.stored() == start[0]
        assert at.again().held() == start[1]
        at = at.again() if restart else at
        assert all_of(at, "redo") == undone
        assert at.stored() == end[0]
        assert restart or at.held() == end[1]


def test_what_is_undone_after_a_restart_goes_back_where_a_prior_took_it_from() -> None:
    """Optimising anew would leave the whole map where the prior has put it."""
    with (
        TemporaryDirectory() as folder,
        MapWriter.open(Path(shutil.copy(made(), Path(folder) / "map.db"))) as writer,
    ):
        at = Session(writer)
        start = at.stored()
        done = prior(at, 7, 4)
        assert done.max_shift_m > 0.5 and not at.review.params.Optimizer.PriorsIgnored
        assert [entry.setting for entry in at.reader.journal()] == [done.entry.setting]
        again = at.again()
        assert not again.review.params.Optimizer.PriorsIgnored
        assert again.review.undo(preview=True).max_shift_m > 0.5
        assert not again.review.params.Optimizer.PriorsIgnored, "a preview changes nothing"
        again.review.undo()
        assert again.stored() == start and again.review.params.Optimizer.PriorsIgnored


def test_poses_that_others_changed_meanwhile_are_not_put_back() -> None:
    with (
        TemporaryDirectory() as folder,
        MapWriter.open(Path(shutil.copy(made(), Path(folder) / "map.db"))) as writer,
    ):
        at = Session(writer)
        at.review.reject(*LOOPS[0])
        number = at.reader.journal()[-1].id
        assert at.reader.poses_before(number) is not None
        moved = {i: UP @ T for i, T in at.reader.poses().items()}
        writer.save_poses(moved, None)
        assert at.reader.poses_before(number) is None
        again = at.again()
        again.review.undo()
        assert np.allclose(again.review.graph.poses[1][:3, 3], moved[1][:3, 3], atol=1e-4), "from where they are"
