"""What stands of the decisions, however they were taken back and made again."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from slam.database.records import JournalEntry
from slam.errors import DecisionError
from slam.history import History

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
