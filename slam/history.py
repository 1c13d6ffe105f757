"""What was decided, undone and can be done again, as the journal tells it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from slam.database.journal_rows import EDITS, VERDICTS
from slam.database.records import JournalEntry
from slam.errors import DecisionError
from slam.graph.shift import Snapshot
from slam.types import Link

#: Decisions whose poses are kept in memory, so that undo and redo are exact; after older ones poses are optimised anew.
EXACT_STEPS = 100


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """A decision that can be taken back, or done again.

    Attributes:
        entry: the decision.
        undo_id: number of the entry that took it back, 0 while it stands.
        here: the poses it must find so that ``there`` holds.
        there: the poses that going this step leads to; None where they are not known (any more).
    """

    entry: JournalEntry
    undo_id: int = 0
    here: Snapshot | None = None
    there: Snapshot | None = None


class History:
    """Two stacks: decisions that stand, and decisions taken back since the last one was made."""

    def __init__(self, journal: Iterable[JournalEntry]) -> None:
        self._standing: list[Step] = []
        self._undone: list[Step] = []
        for entry in journal:
            self.record(entry)

    def record(self, entry: JournalEntry, before: Snapshot | None = None, after: Snapshot | None = None) -> None:
        """Take in an entry as the file numbers it, with the poses before and after it where they are known."""
        if entry.action == "undo":
            self._move(self._standing, self._undone, entry, before, after)
        elif entry.action == "redo":
            self._move(self._undone, self._standing, entry, before, after)
        else:
            self._undone.clear()
            self._push(self._standing, Step(entry, 0, after, before))

    def last(self, pair: tuple[int, int]) -> JournalEntry | None:
        """The last verdict about a pair (smaller id first) that stands."""
        return next((entry for entry in self._about(pair) if entry.action in VERDICTS), None)

    def verdicts(self) -> dict[tuple[int, int], JournalEntry]:
        """The last verdict that stands about each pair that has one."""
        return {step.entry.pair: step.entry for step in self._standing if step.entry.action in VERDICTS}

    def original(self, pair: tuple[int, int]) -> Link | None:
        """The link of a pair (smaller id first) before people edited it; None where they did not."""
        before = None
        for entry in self._about(pair):
            if entry.link_before is None or entry.link_after is None:
                break
            if entry.action in EDITS:
                before = entry.link_before
        return before

    def edited(self, pair: tuple[int, int]) -> JournalEntry | None:
        """The last edit that stands of a pair's link (smaller id first); None where it is as it was before all."""
        last = next((entry for entry in self._about(pair) if entry.action in EDITS), None)
        return None if last is None or last.link_after is None or last.action == "reset" else last

    def _about(self, pair: tuple[int, int]) -> Iterator[JournalEntry]:
        return (step.entry for step in reversed(self._standing) if step.entry.pair == pair)

    def to_undo(self) -> list[Step]:
        """The last decision that stands, and those made together with it, the last first.

        Raises:
            DecisionError: none stands.
        """
        if not self._standing:
            raise DecisionError("nothing to undo: no decision stands")
        return _together(self._standing)

    def to_redo(self) -> list[Step]:
        """The decision taken back last, and those made together with it, in the order in which they were made.

        Raises:
            DecisionError: none was taken back since the last one was made.
        """
        if not self._undone:
            raise DecisionError("nothing to redo: no decision was undone since the last one was made")
        return _together(self._undone)

    def _move(
        self,
        source: list[Step],
        target: list[Step],
        entry: JournalEntry,
        before: Snapshot | None,
        after: Snapshot | None,
    ) -> None:
        """Follow an undo or redo; journals of other programs may name another step than the last."""
        for k in range(len(source) - 1, -1, -1):
            if entry.undoes == (source[k].undo_id or source[k].entry.id):
                step = source.pop(k)
                self._push(target, Step(step.entry, entry.id if entry.action == "undo" else 0, after, before))
                return

    def _push(self, stack: list[Step], step: Step) -> None:
        stack.append(step)
        if len(stack) > EXACT_STEPS:
            stack[-EXACT_STEPS - 1] = replace(stack[-EXACT_STEPS - 1], here=None, there=None)


def _together(stack: Sequence[Step]) -> list[Step]:
    """The top of a stack with what is of the same batch, the top first."""
    batch = stack[-1].entry.batch
    if batch is None:
        return [stack[-1]]
    return list(takewhile(lambda step: step.entry.batch == batch, reversed(stack)))
