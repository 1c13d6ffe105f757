"""Decisions: written with their effect in one transaction, attributable, and never changed afterwards."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from slam.database import Faults, JournalEntry, LoopState, MapReader, MapWriter, SettingChange
from slam.errors import DamagedRowError, DatabaseError
from slam.types import Link, LinkType
from tests.unit.database.map_records import pose, write_map


def find(reader: MapReader, pair: tuple[int, int]) -> Link | None:
    return next((link for link in reader.links() if link.pair == pair), None)


def entry(action: str, pair: tuple[int, int] = (2, 3), **values: object) -> JournalEntry:
    return JournalEntry(action=action, from_id=pair[1], to_id=pair[0], author="ann", **values)  # type: ignore[arg-type]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A closed map of four nodes."""
    return write_map(tmp_path / "map.db", 4)


def test_a_rejected_link_leaves_the_graph_and_lives_on_in_the_journal(path: Path) -> None:
    reader = MapReader(path)
    link = find(reader, (2, 3))
    assert link is not None
    poses = {i: pose(i + 3) for i in (1, 2, 3, 4)}
    with MapWriter.open(path) as writer:
        written = entry(
            "reject", link_before=link, note="a mirror", chi2_before=9.0, chi2_after=4.5, moved=3, max_shift_m=0.2
        )
        assert writer.append_decision(written, remove=[(3, 2)], poses=poses) == 1
    assert find(reader, (2, 3)) is None
    (found,) = reader.journal()
    assert (found.id, found.author, found.action, found.note) == (1, "ann", "reject", "a mirror")
    assert (found.chi2_before, found.chi2_after, found.moved, found.max_shift_m) == (9.0, 4.5, 3, 0.2)
    assert found.time > 1.7e9
    assert found.undone_by is None
    assert found.link_after is None
    assert found.link_before is not None
    assert (found.link_before.from_id, found.link_before.to_id) == (3, 2)
    assert found.link_before.type == LinkType.NEIGHBOR
    assert link.T_from_to is not None
    assert found.link_before.T_from_to is not None
    np.testing.assert_array_equal(found.link_before.T_from_to, link.T_from_to)
    np.testing.assert_array_equal(found.link_before.information, link.information)
    np.testing.assert_array_equal(reader.poses()[2], pose(5).astype(np.float32))
    assert reader.grid() is None


def test_undo_and_redo_tell_what_stands(path: Path) -> None:
    reader = MapReader(path)
    link = find(reader, (2, 3))
    assert link is not None
    states = []
    with MapWriter.open(path) as writer:

        def decide(action: str, *, add: tuple[Link, ...] = (), remove: tuple[tuple[int, int], ...] = ()) -> None:
            writer.append_decision(entry(action), add=add, remove=remove, poses={})
            states.append((find(reader, (2, 3)) is not None, [e.undone_by for e in reader.journal()], state()))

        def state() -> LoopState:
            return next(row.state for row in reader.candidates() if row.candidate.from_id == 3)

        assert state() == LoopState.ACCEPTED
        decide("reject", remove=((2, 3),))
        decide("undo", add=(link,))
        decide("redo", remove=((2, 3),))
        decide("undo", add=(link,))
        decide("approve")
    assert states == [
        (False, [None], LoopState.REJECTED),
        (True, [2, None], LoopState.ACCEPTED),
        (False, [None, 3, None], LoopState.REJECTED),
        (True, [4, 3, None, None], LoopState.ACCEPTED),
        (True, [4, 3, None, None, None], LoopState.APPROVED),
    ]
    assert [e.undoes for e in reader.journal()] == [None, 1, 2, 1, None]


def test_nothing_to_take_back_is_refused(path: Path) -> None:
    with MapWriter.open(path) as writer:
        for action in ("undo", "redo"):
            with pytest.raises(DatabaseError, match=f"nothing to {action} about link 3-2"):
                writer.append_decision(entry(action), poses={})
        with pytest.raises(DatabaseError, match="decision 'ponder' is unknown"):
            writer.append_decision(entry("ponder"), poses={})


def test_a_decision_that_fails_leaves_no_trace(path: Path) -> None:
    reader = MapReader(path)
    grid, poses = reader.grid(), reader.poses()
    with MapWriter.open(path) as writer:
        with pytest.raises(DatabaseError, match=r"deciding about link 3-2 failed: .* can't be removed"):
            writer.append_decision(entry("reject"), remove=[(2, 3), (1, 4)], poses={1: pose(9)})
        with pytest.raises(DatabaseError, match="node 9 is not in the map"):
            added = Link(9, 1, LinkType.USER_CLOSURE, pose(1), np.eye(6))
            writer.append_decision(entry("add"), add=[added], poses={})
    assert reader.journal() == []
    assert find(reader, (2, 3)) is not None
    assert grid is not None
    found = reader.grid()
    assert found is not None
    np.testing.assert_array_equal(found.cells, grid.cells)
    np.testing.assert_array_equal(reader.poses()[1], poses[1])


def test_approving_what_is_there_keeps_the_grid(path: Path) -> None:
    with MapWriter.open(path) as writer:
        writer.append_decision(entry("approve"), poses=MapReader(path).poses())
    assert MapReader(path).grid() is not None


def test_rows_are_only_added(path: Path) -> None:
    def rows() -> list[tuple[object, ...]]:
        with closing(sqlite3.connect(path)) as connection:
            return connection.execute("SELECT * FROM deck_journal ORDER BY id").fetchall()

    before: list[tuple[object, ...]] = []
    for action in ("approve", "undo", "redo"):
        with MapWriter.open(path) as writer:
            writer.append_decision(entry(action), poses={})
        assert rows()[: len(before)] == before
        before = rows()
    assert len(before) == 3


def test_a_journal_of_an_earlier_version_is_read_and_gone_on_with(path: Path) -> None:
    with MapWriter.open(path) as writer:
        writer.append_decision(entry("approve"), poses={})
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("DROP TABLE deck_decision")
        connection.commit()
    assert [(e.action, e.batch, e.ate_after) for e in MapReader(path).journal()] == [("approve", None, None)]
    with MapWriter.open(path) as writer:
        writer.append_decisions([entry("undo"), entry("redo")], poses={})
    assert [(e.action, e.batch) for e in MapReader(path).journal()] == [("approve", None), ("undo", 2), ("redo", 2)]


def test_poses_before_the_last_decisions_are_kept_and_damage_is_named(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("slam.database.poses_before._KEPT", 2)
    with MapWriter.open(path) as writer:
        for k in range(4):
            writer.append_decision(entry("approve"), poses={i: pose(i + k) for i in (1, 2, 3, 4)})
    reader = MapReader(path)
    assert [reader.poses_before(k) is None for k in (1, 2, 3, 4)] == [True] * 3 + [False], "3 did not leave these poses"
    before = reader.poses_before(4)
    assert before is not None
    np.testing.assert_array_equal(before[2], pose(4).astype(np.float32))
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("SELECT id FROM deck_poses_before ORDER BY id").fetchall() == [(3,), (4,)]
        connection.execute("UPDATE deck_poses_before SET poses = ids")
        connection.commit()
    with pytest.raises(DatabaseError, match="deck_poses_before has 4 ids and 4 numbers"):
        reader.poses_before(4)


def test_a_parameter_that_a_decision_changed_is_in_force_and_nonsense_is_named(path: Path) -> None:
    change = SettingChange("Optimizer/PriorsIgnored", "true", "false")
    with MapWriter.open(path) as writer:
        writer.append_decision(entry("approve", setting=change), poses={})
    reader = MapReader(path)
    assert reader.journal()[0].setting == change
    assert reader.parameters()[change.name] == "false"
    assert [(one.name, one.value) for one in reader.parameter_changes()] == [(change.name, "false")]
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE deck_setting_change SET before = 'maybe'")
        connection.commit()
    with pytest.raises(DamagedRowError, match="deck_setting_change"):
        reader.journal()
    faults: Faults = {}
    assert [one.setting for one in reader.journal(faults)] == [None]
    assert [fault.table for fault in faults] == ["deck_setting_change"]
