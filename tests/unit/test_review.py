"""Decisions about loops: what they do to graph, file and journal, and that each can be taken back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.database import JournalEntry, MapReader, MapWriter
from slam.effect import Effect
from slam.errors import DatabaseError, DecisionError
from slam.geometry import Pose, between
from slam.graph import PoseGraph, optimize
from slam.params import Params
from slam.review import Review
from slam.types import Candidate, Link, LinkType, Refusal
from tests.graphs import INFORMATION, circles, loop, stacked, truth, write_map

PARAMS = Params()
NODES = 60
#: A refused candidate with a transform, and one without.
REFUSED, EMPTY = (55, 15), (50, 10)
LOOPS = sorted(pair for pair in circles(NODES).links if pair[1] - pair[0] > 1)


def candidate(a: int, b: int, *, found: bool = True) -> Candidate:
    link = loop(a, b, truth(NODES), np.random.default_rng(a))
    test = "RGBD/OptimizeMaxError" if found else "Vis/MinInliers"
    why = Refusal(test, 5.0, 3.0, f"{test} says no")
    transform = (link.T_from_to, link.information) if found else (None, None)
    return Candidate(a, b, LinkType.GLOBAL_CLOSURE, 0.3, 90, 12, *transform, why)


@dataclass
class Row:
    candidate: Candidate


@dataclass
class File:
    """A map file in memory: what a review reads and writes."""

    rows: list[Row] = field(default_factory=list)
    entries: list[JournalEntry] = field(default_factory=list)
    links: dict[tuple[int, int], Link] = field(default_factory=dict)
    poses: dict[int, Pose] = field(default_factory=dict)
    full: bool = False

    def journal(self) -> list[JournalEntry]:
        return self.entries

    def candidates(self) -> list[Row]:
        return self.rows

    def poses_before(self, number: int) -> None:
        assert number > 0

    def append_decisions(
        self,
        entries: Sequence[JournalEntry],
        *,
        add: Sequence[Link] = (),
        remove: Sequence[tuple[int, int]] = (),
        poses: Mapping[int, Pose],
        candidates: Sequence[Candidate] = (),
    ) -> list[int]:
        if self.full:
            raise DatabaseError("disk full")
        self.rows += [Row(item) for item in candidates]
        for a, b in remove:
            del self.links[min(a, b), max(a, b)]
        for link in add:
            assert link.pair not in self.links
            self.links[link.pair] = link
        self.poses = dict(poses) or self.poses
        first = len(self.entries) + 1
        batch = first if len(entries) > 1 else None
        self.entries += [replace(entry, id=first + k, batch=batch) for k, entry in enumerate(entries)]
        return list(range(first, len(self.entries) + 1))


def opened(seed: int = 0) -> tuple[Review, File]:
    graph = circles(NODES, seed=seed)
    graph.poses = optimize(graph, PARAMS).poses
    rows = [Row(candidate(*REFUSED)), Row(candidate(*EMPTY, found=False))]
    file = File(rows, links=dict(graph.links), poses=dict(graph.poses))
    return Review(graph, file, file, PARAMS), file


def state(review: Review, file: File) -> tuple[dict[tuple[int, int], Link], bytes]:
    graph = review.graph
    assert graph.links == file.links, "file and graph agree"
    assert np.array_equal(stacked(graph.poses), stacked(file.poses))
    for i in graph.poses:
        assert all(graph.links[link.pair] is link and i in link.pair for link in graph.neighbors(i).values())
    return dict(graph.links), stacked(graph.poses).tobytes()


def test_rejecting_removes_the_link_and_says_what_it_did() -> None:
    review, file = opened()
    pair = LOOPS[-1]
    effect = review.reject(*pair, author="ann")
    assert pair not in review.graph.links
    assert effect.chi2_after < effect.chi2_before
    assert effect.moved > 0
    assert effect.max_shift_m > 0
    assert effect.separated == 0
    assert (effect.entry.id, effect.entry.action, effect.entry.author) == (1, "reject", "ann")
    assert effect.entry.link_before is not None
    assert effect.entry.link_after is None
    assert (effect.entry.moved, effect.entry.max_shift_m) == (effect.moved, effect.max_shift_m)
    state(review, file)


def test_chi2_is_that_of_all_links() -> None:
    review, _ = opened()
    before = optimize(review.graph, PARAMS).chi2_before
    effect = review.reject(*LOOPS[0])
    assert effect.chi2_before == pytest.approx(before)
    assert effect.chi2_after == pytest.approx(optimize(review.graph, PARAMS).chi2_before)


def test_approving_an_accepted_loop_is_a_mark() -> None:
    review, file = opened()
    before = state(review, file)
    effect = review.approve(*LOOPS[0])
    assert state(review, file) == before
    assert effect.entry.action == "approve"
    assert effect.entry.link_before is effect.entry.link_after
    assert (effect.moved, effect.max_shift_m) == (0, 0.0)
    assert effect.chi2_before == effect.chi2_after
    assert review.undo().entry.undoes == 1
    assert state(review, file) == before


def test_approving_a_refused_candidate_adds_it_as_a_users_link() -> None:
    review, file = opened()
    effect = review.approve(*REFUSED)
    link = review.graph.links[REFUSED[1], REFUSED[0]]
    assert (link.from_id, link.to_id, link.type) == (*REFUSED, LinkType.USER_CLOSURE)
    assert effect.entry.action == "add"
    assert effect.chi2_after > effect.chi2_before
    state(review, file)


def test_rejecting_a_refused_candidate_confirms_it() -> None:
    review, file = opened()
    before = state(review, file)
    assert review.reject(*REFUSED).entry.action == "reject"
    assert state(review, file) == before
    review.undo()
    review.approve(*REFUSED)


def test_a_rejected_loop_can_be_approved_again_as_it_was() -> None:
    review, file = opened()
    link = review.graph.links[LOOPS[0]]
    review.reject(*LOOPS[0])
    assert review.approve(*LOOPS[0]).entry.action == "add"
    assert review.graph.links[LOOPS[0]] is link
    state(review, file)


@pytest.mark.parametrize(
    ("action", "pair", "says"),
    [
        ("reject", (3, 4), "is odometry"),
        ("approve", (3, 4), "is no loop"),
        ("approve", (3, 40), "none can be added"),
        ("reject", (3, 40), "not linked"),
        ("approve", EMPTY, r"found no transform \(Vis/MinInliers says no\)"),
        ("reject", (3, 99), "not linked"),
    ],
)
def test_what_can_not_be_decided_is_refused_with_the_reason(action: str, pair: tuple[int, int], says: str) -> None:
    review, file = opened()
    before = state(review, file)
    with pytest.raises(DecisionError, match=says):
        getattr(review, action)(*pair)
    assert state(review, file) == before
    assert not file.entries


def test_the_same_decision_twice_is_refused() -> None:
    review, _ = opened()
    for action, pair in (("approve", LOOPS[0]), ("reject", LOOPS[1]), ("approve", REFUSED), ("reject", EMPTY)):
        getattr(review, action)(*pair)
        with pytest.raises(DecisionError, match="already, by decision"):
            getattr(review, action)(*pair)


def test_nothing_to_undo_or_redo_is_said() -> None:
    review, _ = opened()
    with pytest.raises(DecisionError, match="nothing to undo"):
        review.undo()
    with pytest.raises(DecisionError, match="nothing to redo"):
        review.redo()
    review.reject(*LOOPS[0])
    review.undo()
    review.reject(*LOOPS[1])
    with pytest.raises(DecisionError, match="nothing to redo"):
        review.redo()


def test_what_can_not_be_written_is_not_done() -> None:
    review, file = opened()
    review.reject(*LOOPS[0])
    before, file.full = state(review, file), True
    for act in (lambda: review.reject(*LOOPS[1]), lambda: review.approve(*REFUSED), review.undo):
        with pytest.raises(DatabaseError):
            act()
        assert state(review, file) == before
    file.full = False
    review.undo()
    assert LOOPS[0] in review.graph.links


def test_together_is_what_one_by_one_comes_to_and_one_undo_takes_it_back() -> None:
    review, file = opened()
    single, _ = opened()
    start, chosen = state(review, file), LOOPS[:4]
    effect = review.decide("reject", [*chosen, (3, 4), chosen[0][::-1]], "ann")
    assert [entry.pair for entry in effect.entries] == chosen, "each once"
    assert [(one.from_id, one.to_id) for one in effect.refused] == [(3, 4)]
    assert "is odometry" in effect.refused[0].reason
    assert {(entry.batch, entry.author) for entry in file.entries} == {(1, "ann")}
    for pair in chosen:
        last = single.reject(*pair)
    assert np.allclose(stacked(review.graph.poses), stacked(single.graph.poses), atol=1e-4)
    assert effect.chi2_after == pytest.approx(last.chi2_after, rel=1e-3)
    after = state(review, file)
    review.approve(*REFUSED)
    review.undo()
    assert [entry.undoes for entry in review.undo().entries] == [4, 3, 2, 1]
    assert state(review, file) == start
    assert [entry.pair for entry in review.redo().entries] == chosen
    assert state(review, file) == after
    again = Review(review.graph, file, file, PARAMS)
    assert len(again.undo().entries) == 4, "the journal alone knows it"
    assert set(again.graph.links) == set(start[0])


def test_a_preview_says_what_the_decision_then_does_and_changes_nothing() -> None:
    review, file = opened()
    review.reject(*LOOPS[5])
    for act in (
        lambda preview: review.decide("reject", LOOPS[:3], preview=preview),
        lambda preview: review.decide("approve", [REFUSED, LOOPS[5], EMPTY], preview=preview),
        lambda preview: review.undo(preview=preview),
        lambda preview: review.redo(preview=preview),
    ):
        before, written = state(review, file), len(file.entries)
        said = act(True)
        assert said.preview
        assert state(review, file) == before
        assert len(file.entries) == written
        done = act(False)
        assert (said.chi2_before, said.chi2_after, said.moved, said.max_shift_m, said.refused) == (
            done.chi2_before,
            done.chi2_after,
            done.moved,
            done.max_shift_m,
            done.refused,
        )


def test_none_of_several_that_can_be_decided_is_refused() -> None:
    review, file = opened()
    with pytest.raises(DecisionError, match=r"none of these 2 loops can be rejected; the first: .*is odometry"):
        review.decide("reject", [(3, 4), (4, 5)])
    with pytest.raises(DecisionError, match="no loop is named"):
        review.decide("approve", [])
    assert not file.entries


decisions = st.lists(
    st.tuples(
        st.sampled_from(["approve", "reject", "reject more", "undo", "redo"]),
        st.sampled_from([*LOOPS, REFUSED, EMPTY, (3, 4)]),
    ),
    max_size=10,
)


def act(review: Review, action: str, pair: tuple[int, int]) -> Effect | None:
    try:
        if action == "reject more":
            return review.decide("reject", [pair, *LOOPS[2:5]])
        return (
            review.undo() if action == "undo" else review.redo() if action == "redo" else getattr(review, action)(*pair)
        )
    except DecisionError:
        return None


@settings(max_examples=25, deadline=None)
@given(decisions, st.integers(0, 9))
def test_any_decisions_and_undoing_them_all_is_the_start_to_the_last_bit(
    actions: list[tuple[str, tuple[int, int]]], seed: int
) -> None:
    review, file = opened(seed)
    start = state(review, file)
    for action, pair in actions:
        before, written = state(review, file), len(file.entries)
        effect = act(review, action, pair)
        if effect is None:
            assert state(review, file) == before, "a refusal changes nothing"
            assert len(file.entries) == written
        else:
            assert file.entries[-1].id == effect.entries[-1].id
            assert len(file.entries) == written + len(effect.entries), "nothing is silent"
    while act(review, "undo", (0, 0)) is not None:
        pass
    assert state(review, file) == start


@settings(max_examples=15, deadline=None)
@given(decisions)
def test_undo_and_redo_of_everything_is_where_it_was(actions: list[tuple[str, tuple[int, int]]]) -> None:
    review, file = opened()
    for action, pair in actions:
        act(review, action, pair)
    end, undone = state(review, file), 0
    while act(review, "undo", (0, 0)) is not None:
        undone += 1
    for _ in range(undone):
        review.redo()
    assert state(review, file) == end


@settings(max_examples=15, deadline=None)
@given(decisions)
def test_the_journal_alone_knows_what_to_undo(actions: list[tuple[str, tuple[int, int]]]) -> None:
    review, file = opened()
    start = dict(review.graph.links)
    for action, pair in actions:
        act(review, action, pair)
    again = Review(review.graph, file, file, PARAMS)
    while (a := act(again, "undo", (0, 0))) is not None:
        assert file.entries[-1].id == a.entries[-1].id
    assert again.graph.links == start
    assert np.allclose(stacked(again.graph.poses), stacked(opened()[0].graph.poses), atol=1e-4)


def test_undo_after_the_map_grew_optimises_anew() -> None:
    review, file = opened()
    link = review.graph.links[LOOPS[0]]
    review.reject(*LOOPS[0])
    graph, T = review.graph, review.graph.poses[NODES]
    graph.add_node(NODES + 1, 0, T, T)
    graph.add_link(Link(NODES, NODES + 1, LinkType.NEIGHBOR, np.eye(4), INFORMATION))
    effect = review.undo()
    assert graph.links[LOOPS[0]] is link
    assert np.allclose(between(graph.poses[NODES], graph.poses[NODES + 1]), np.eye(4), atol=1e-6)
    assert effect.moved > 0
    assert NODES + 1 in file.poses


def test_taking_sessions_apart_and_joining_them_again() -> None:
    graph = circles(NODES)
    graph.remove_link((30, 31))
    bridge, *others = [pair for pair in LOOPS if pair[0] <= 30 < pair[1]]
    for pair in others:
        graph.remove_link(pair)
    graph.poses = optimize(graph, PARAMS).poses
    file = File(links=dict(graph.links), poses=dict(graph.poses))
    review, before = Review(graph, file, file, PARAMS), stacked(graph.poses)
    effect = review.reject(*bridge)
    assert effect.separated == 30
    assert effect.moved == 0, "each part keeps its shape and place"
    assert review.undo().separated == 0
    assert np.array_equal(stacked(graph.poses), before)


def test_ate_is_told_where_truth_is_known() -> None:
    review, file = opened()
    true = truth(NODES)

    def ate(poses: Mapping[int, Pose]) -> float:
        return float(np.sqrt(np.mean([np.sum((poses[i + 1] - T)[:3, 3] ** 2) for i, T in enumerate(true)])))

    known = Review(review.graph, file, file, PARAMS, ate)
    before = ate(review.graph.poses)
    effect = known.reject(*LOOPS[0])
    assert effect.ate_before == before
    assert effect.ate_after == ate(review.graph.poses) != before
    assert known.undo().ate_after == before
    assert opened()[0].reject(*LOOPS[0]).ate_before is None


def test_in_a_real_file_decisions_survive_a_restart(tmp_path: Path) -> None:
    graph = circles(NODES)
    graph.poses = optimize(graph, PARAMS).poses
    path = write_map(tmp_path / "a.db", graph, {NODES: (candidate(*REFUSED), candidate(*EMPTY, found=False))})

    def session() -> tuple[MapWriter, Review]:
        reader, writer = MapReader(path), MapWriter.open(path)
        return writer, Review(PoseGraph.from_reader(reader), writer, reader, PARAMS)

    writer, review = session()
    start = set(review.graph.links)
    with writer:
        review.reject(*LOOPS[0], author="ann")
        review.approve(*REFUSED)
    writer, review = session()
    with writer:
        assert set(review.graph.links) == start - {LOOPS[0]} | {REFUSED[::-1]}
        assert review.undo().entry.action == "undo"
        assert review.redo().entry.action == "redo"
        review.undo()
        review.undo()
        assert set(review.graph.links) == start
        with pytest.raises(DecisionError):
            review.undo()
    reader = MapReader(path)
    assert [e.action for e in reader.journal()] == ["reject", "add", "undo", "redo", "undo", "undo"]
    assert set(PoseGraph.from_reader(reader).links) == start
    assert np.allclose(stacked(reader.poses()), stacked(graph.poses), atol=1e-3)
    assert np.array_equal(stacked(reader.poses()).astype(np.float32), stacked(review.graph.poses).astype(np.float32))
