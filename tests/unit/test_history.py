"""What stands of the decisions, however they were taken back and made again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.database.records import JournalEntry
from slam.errors import DecisionError
from slam.history import History
from slam.types import Link, LinkType

PAIRS = [(1, 5), (2, 6), (3, 7)]
steps = st.one_of(
    st.tuples(st.sampled_from(["approve", "reject", "edit"]), st.sampled_from(PAIRS)),
    st.tuples(st.sampled_from(["undo", "redo"]), st.none()),
)


@given(st.lists(steps, max_size=30))
def test_the_verdicts_are_the_last_of_each_pair(made: list[tuple[str, tuple[int, int] | None]]) -> None:
    history = History([])
    for number, (action, pair) in enumerate(made, start=1):
        if pair is not None:
            history.record(JournalEntry(action=action, from_id=pair[1], to_id=pair[0], author="", id=number))
            continue
        try:
            step = (history.to_undo if action == "undo" else history.to_redo)()[0]
        except DecisionError:
            continue
        entry = step.entry
        undoes = step.undo_id or entry.id
        history.record(
            JournalEntry(action=action, from_id=entry.from_id, to_id=entry.to_id, author="", id=number, undoes=undoes)
        )
    last = {pair: history.last(pair) for pair in PAIRS}
    assert history.verdicts() == {pair: entry for pair, entry in last.items() if entry is not None}


def test_an_edit_of_a_link_stands_until_it_is_undone_or_the_link_is_reset() -> None:
    link = Link(6, 2, LinkType.NEIGHBOR, np.eye(4), np.eye(6))
    edit = JournalEntry(action="edit", from_id=6, to_id=2, author="", id=1, link_before=link, link_after=link)
    history = History([edit, replace(edit, action="approve", id=2)])
    assert history.edited((2, 6)) == edit
    assert history.edited((1, 5)) is None
    undone = History([edit, replace(edit, action="undo", id=2, undoes=1)])
    assert undone.edited((2, 6)) is None
    history.record(replace(edit, action="reset", id=3))
    assert history.edited((2, 6)) is None
