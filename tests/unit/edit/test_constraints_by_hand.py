"""Priors and covariances by hand: undo gives back every bit, and a prior that is ignored moves nothing."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from slam.database import JournalEntry, MapReader, MapWriter
from slam.edit.covariances import weighing
from slam.edit.detect import detect_more
from slam.edit.nodes import labelling
from slam.edit.priors import placing, prior_of
from slam.edit.views import StoredViews
from slam.edit.wishes import CovarianceEdit, Detection, PriorEdit
from slam.errors import DecisionError
from slam.geometry import se3_exp
from slam.graph import PoseGraph, optimize
from slam.params import Params
from slam.review import Review
from slam.types import UNKNOWN_VARIANCE, Link, LinkType
from tests.graphs import circles, stacked, write_map

PARAMS = Params().changed({"Optimizer/PriorsIgnored": False, "Optimizer/LandmarksIgnored": False})
NODES = 30
SIGMAS = np.array([0.01, 0.01, 0.01, 0.005, 0.005, 0.005])
UP = se3_exp(np.array([0.0, 0.0, 2.0, 0.0, 0.0, 0.0]))
Opened = tuple[Review, MapReader, MapWriter]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = write_map(tmp_path_factory.mktemp("made") / "map.db", circles(NODES, loops=3))
    with MapWriter.open(path) as writer:
        gravity = [Link(i, i, LinkType.GRAVITY, np.eye(4), np.eye(6)) for i in (5, 25)]
        seen = [Link(i, -1, LinkType.LANDMARK, se3_exp(np.array([1.0, 0, 0, 0, 0, 0])), np.eye(6)) for i in (5, 6)]
        writer.add_links([*gravity, *seen])
        writer.save_poses(optimize(PoseGraph.from_reader(MapReader(path)), PARAMS).poses, None)
    return path


@pytest.fixture
def opened(made: Path, tmp_path: Path) -> Iterator[Opened]:
    with MapWriter.open(Path(shutil.copy(made, tmp_path / "map.db"))) as writer:
        reader = MapReader(writer.path)
        yield Review(PoseGraph.from_reader(reader), writer, reader, PARAMS), reader, writer


def state(review: Review, reader: MapReader) -> list[object]:
    """Everything that an edit may change, in RAM and in the file, as bytes."""
    graph = review.graph
    links = [*graph.links.values(), *graph.constraints.values()]
    rows = {(k.from_id, k.to_id, k.type): (k.T_from_to, k.information) for k in reader.links()}
    held = [
        (key, np.asarray(T).tobytes(), information.tobytes())
        for key, (T, information) in sorted(
            {**{(k.from_id, k.to_id, k.type): (k.T_from_to, k.information) for k in links}}.items()
        )
    ]
    stored = [(key, np.asarray(T).tobytes(), information.tobytes()) for key, (T, information) in sorted(rows.items())]
    labels = [label or "" for label in reader.nodes().labels]
    poses = [stacked(dict(graph.poses)).tobytes(), stacked(dict(reader.poses())).tobytes()]
    return [held, stored, labels, sorted(graph.poses), *poses]


def file_part(seen: list[object]) -> list[object]:
    """Of a state what the file alone holds: rows of links, labels, nodes, poses."""
    return [*seen[1:4], seen[-1]]


def prior(node_id: int, review: Review, **changes: object) -> JournalEntry:
    T = np.asarray(UP @ review.graph.poses.get(node_id, np.eye(4)))
    return placing(
        review.graph,
        review.params,
        replace(PriorEdit(node_id=node_id, T_map_base=T, sigmas=SIGMAS, author="ann"), **changes),
    )


def weights(review: Review, **chosen: object) -> list[JournalEntry]:
    return weighing(review.graph, CovarianceEdit(sigmas=SIGMAS, author="ann", **chosen))  # type: ignore[arg-type]


EDITS = {
    "prior": lambda review, _: [prior(25, review)],
    "position": lambda review, _: [prior(25, review, sigmas=np.array([0.1, 0.1, 0.2, 0, 0, 0]))],
    "neighbours": lambda review, _: weights(review, types=(LinkType.NEIGHBOR,)),
    "loops": lambda review, _: weights(review, types=(LinkType.GLOBAL_CLOSURE,), first=2),
    "landmarks": lambda review, _: weights(review, types=(LinkType.LANDMARK,)),
    "labels": lambda review, reader: labelling(review.graph, reader, [7, 3, 9], "door", "ann"),
}


@pytest.mark.parametrize("kind", EDITS)
def test_undo_is_what_was_before_and_redo_what_was_after_to_the_last_bit(opened: Opened, kind: str) -> None:
    review, reader, writer = opened
    # From here on the file has the poses in full precision.
    review.change([prior(10, review)])
    before = state(review, reader)
    foreseen = review.change(EDITS[kind](review, reader), preview=True)
    assert state(review, reader) == before
    done = review.change(EDITS[kind](review, reader))
    assert (done.chi2_after, done.moved) == (foreseen.chi2_after, foreseen.moved)
    after = state(review, reader)
    assert after != before
    review.undo("bob")
    assert state(review, reader) == before
    review.redo("bob")
    assert state(review, reader) == after
    # After a restart too: what the file holds is what it held before, poses among it.
    again = Review(PoseGraph.from_reader(reader), writer, reader, PARAMS)
    again.undo()
    assert file_part(state(again, reader)) == file_part(before)
    again.redo()
    assert file_part(state(again, reader)) == file_part(after)


def test_a_prior_lifts_its_node_and_only_where_priors_count(opened: Opened) -> None:
    review, _, _ = opened
    wanted = UP @ review.graph.poses[25]
    review.params = PARAMS.changed({"Optimizer/PriorsIgnored": True})
    ignored = review.change([prior(25, review)])
    assert ignored.max_shift_m < 1e-4
    review.params = PARAMS
    # The same prior again: now it counts.
    again = review.change(
        [placing(review.graph, review.params, PriorEdit(node_id=25, T_map_base=wanted, sigmas=SIGMAS))]
    )
    assert again.max_shift_m > 0.1
    assert np.allclose(review.graph.poses[25][:3, 3], wanted[:3, 3], atol=0.05)
    review.undo()
    assert np.allclose(review.graph.poses[25][2, 3], wanted[2, 3] - 2.0, atol=0.05), "as it was while it was ignored"


def test_taking_a_prior_away_leaves_gravity_alone(opened: Opened) -> None:
    review, reader, _ = opened
    review.change([prior(25, review)])
    kinds = {k.type for k in reader.links() if k.pair == (25, 25)}
    assert kinds == {LinkType.GRAVITY, LinkType.POSE_PRIOR}
    review.change([placing(review.graph, review.params, PriorEdit(node_id=25))])
    assert {k.type for k in reader.links() if k.pair == (25, 25)} == {LinkType.GRAVITY}
    assert prior_of(review.graph, 25) is None
    assert (25, 25, LinkType.GRAVITY) in review.graph.constraints


def test_typed_sigmas_are_the_covariance_and_0_means_unknown(opened: Opened) -> None:
    review, reader, _ = opened
    sigmas = np.array([0.02, 0.02, 0.03, 0.01, 0.01, 0.0])
    wanted = CovarianceEdit(sigmas=sigmas, types=(LinkType.GLOBAL_CLOSURE,), last=28)
    review.change(weighing(review.graph, wanted))
    for link in reader.links():
        meant = link.type is LinkType.GLOBAL_CLOSURE and link.pair[1] <= 28
        variances = np.diagonal(np.linalg.inv(link.information))
        expected = [4e-4, 4e-4, 9e-4, 1e-4, 1e-4, UNKNOWN_VARIANCE]
        assert np.allclose(variances, expected) == meant
    with pytest.raises(DecisionError, match="have these sigmas already"):
        weighing(review.graph, wanted)


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (lambda r: prior(99, r), "node 99 is not"),
        (lambda r: placing(r.graph, r.params, PriorEdit(node_id=25)), "no prior that could be taken away"),
        (lambda r: prior(25, r, sigmas=np.array([0.1, 0, 0.1, 0, 0, 0])), "x, y and z"),
        (lambda r: prior(25, r, sigmas=np.array([0.1, 0.1, 0.1, 0, 0, 1.0])), "three zeros"),
        (lambda r: prior(25, r, sigmas=-SIGMAS), "not below 0"),
        (lambda r: prior(25, r, T_map_base=np.full((4, 4), np.nan)), "finite"),
        (lambda r: weights(r, types=(LinkType.LOCAL_TIME_CLOSURE,)), "no link is of these types"),
        (lambda r: weights(r, session=3), "no node is of session 3: the map has 0"),
        (lambda r: weighing(r.graph, CovarianceEdit(sigmas=np.zeros(6))), "one axis at least"),
    ],
)
def test_what_makes_no_sense_is_refused(opened: Opened, wrong: object, why: str) -> None:
    review, reader, _ = opened
    with pytest.raises(DecisionError, match=why):
        wrong(review)  # type: ignore[operator]
    assert not reader.journal()


def test_a_detection_that_could_find_nothing_is_refused(opened: Opened) -> None:
    review, reader, _ = opened
    for wanted, why in (
        (Detection(radius_m=1.0, min_radius_m=2.0), "smallest distance, 2 m"),
        (Detection(session=7), "session 7"),
    ):
        with pytest.raises(DecisionError, match=why):
            next(detect_more(review, StoredViews(reader), wanted))


def test_labels_of_many_are_numbered_taken_away_and_never_given_twice(opened: Opened) -> None:
    review, reader, _ = opened
    review.change(labelling(review.graph, reader, [7, 3, 9], "door", ""))
    labels = {i: label for i, label in zip(reader.nodes().ids.tolist(), reader.nodes().labels, strict=True) if label}
    assert labels == {1: "map0", 3: "door 1", 7: "door 2", 9: "door 3"}
    with pytest.raises(DecisionError, match="node 3 has it"):
        labelling(review.graph, reader, [4, 5], "door", "")
    review.change(labelling(review.graph, reader, [1, 3, 7], "", ""))
    assert [label for label in reader.nodes().labels if label] == ["door 3"]
    with pytest.raises(DecisionError, match="these 2 nodes have no label"):
        labelling(review.graph, reader, [1, 2], " ", "")


def test_a_single_position_moves_the_map_and_turns_nothing(opened: Opened) -> None:
    review, _, _ = opened
    # Without gravity, which would say how the map is turned.
    review.params = PARAMS.changed({"Optimizer/GravitySigma": 0.0})
    review.graph.poses = optimize(review.graph, review.params).poses
    before = stacked(review.graph.poses)
    review.change([prior(25, review, sigmas=np.array([0.1, 0.1, 0.1, 0, 0, 0]))])
    moved = stacked(review.graph.poses)
    assert np.allclose(moved[:, :3, 3] - before[:, :3, 3], [0, 0, 2.0], atol=1e-3)
    assert np.allclose(moved[:, :3, :3], before[:, :3, :3], atol=1e-4)


def test_rows_of_links_keep_every_bit_of_both_directions_when_only_their_weight_changes(opened: Opened) -> None:
    review, reader, _ = opened

    def rows() -> list[tuple[object, ...]]:
        with closing(sqlite3.connect(reader.path)) as file:
            return sorted(file.execute("SELECT from_id, to_id, type, transform, information_matrix FROM Link"))

    before = rows()
    review.change(weights(review, types=(LinkType.NEIGHBOR, LinkType.LANDMARK)))
    after = rows()
    assert [row[:4] for row in after] == [row[:4] for row in before] and after != before
    review.undo()
    assert rows() == before
