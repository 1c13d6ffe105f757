"""People's decisions about loops: approve, reject, undo and redo, each with what it did to the map."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Protocol

from slam.database.records import JournalEntry
from slam.errors import DecisionError, OptimizationError
from slam.geometry import Pose
from slam.graph.exchange import with_link, without_link
from slam.graph.graph import PoseGraph, name
from slam.graph.optimizer import chi2
from slam.graph.shift import Shift, Snapshot
from slam.history import History
from slam.params import Params
from slam.types import Candidate, Link, LinkType

#: Poses (id -> T_map_base) -> absolute trajectory error in metres, None without ground truth.
Ate = Callable[[Mapping[int, Pose]], float | None]


class LookedAt(Protocol):
    """A row of the map file about a loop that was looked at."""

    @property
    def candidate(self) -> Candidate:
        """The evidence."""
        ...


class DecisionReader(Protocol):
    """What a review asks of a map file."""

    def journal(self) -> Sequence[JournalEntry]:
        """All decisions, oldest first."""
        ...

    def candidates(self) -> Sequence[LookedAt]:
        """All loops that were looked at, oldest first."""
        ...


class DecisionWriter(Protocol):
    """What a review asks of the one writer of a map file."""

    def append_decision(
        self,
        entry: JournalEntry,
        *,
        add: Sequence[Link] = (),
        remove: Sequence[tuple[int, int]] = (),
        poses: Mapping[int, Pose],
    ) -> int:
        """Write journal, links and optimised poses in one transaction; returns the entry's number."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """What a decision did.

    Attributes:
        entry: the journal's entry.
        chi2_before: sum of squared, whitened residuals of all links before.
        chi2_after: the same after.
        moved: poses that moved by more than 1 mm or 0.05 deg.
        max_shift_m: the farthest that one moved, metres.
        ate_before: absolute trajectory error in metres before, None without ground truth.
        ate_after: the same after.
        separated: nodes that lost their way to the oldest node of their graph.
    """

    entry: JournalEntry
    chi2_before: float
    chi2_after: float
    moved: int
    max_shift_m: float
    ate_before: float | None
    ate_after: float | None
    separated: int


class Review:
    """Decisions about the loops of one map; each is journalled, and each can be undone, after a restart too.

    Attributes:
        graph: the map's graph, which decisions change.
        params: for optimising it; replace it when a parameter has changed.
    """

    def __init__(
        self, graph: PoseGraph, writer: DecisionWriter, reader: DecisionReader, params: Params, ate: Ate | None = None
    ) -> None:
        self.graph = graph
        self.params = params
        self._writer = writer
        self._reader = reader
        self._ate = ate
        self._history = History(reader.journal())

    def approve(self, from_id: int, to_id: int, author: str = "") -> Effect:
        """Say that a loop is true: marks one that is in the graph, adds one that was refused or rejected.

        Raises:
            DecisionError: it is no loop, is approved already, or has no transform that could be added.
        """
        link, last = self.graph.links.get(_pair(from_id, to_id)), self._history.last(_pair(from_id, to_id))
        if link is None:
            return self._decide("add", None, self._addable(from_id, to_id, last), author)
        if not link.type.is_loop:
            raise DecisionError(f"link {name(link)} is no loop: only loop closures are approved or rejected")
        if last is not None and last.action in ("approve", "add"):
            raise DecisionError(f"link {name(link)} is approved already, by decision {last.id}; undo that first")
        return self._decide("approve", link, link, author)

    def reject(self, from_id: int, to_id: int, author: str = "") -> Effect:
        """Say that a loop is false: removes one that is in the graph, marks one that was refused.

        Raises:
            DecisionError: it is odometry, is rejected already, or unknown.
        """
        link, last = self.graph.links.get(_pair(from_id, to_id)), self._history.last(_pair(from_id, to_id))
        if link is not None and not link.type.is_loop:
            raise DecisionError(f"link {name(link)} is odometry and can't be rejected: the path would come apart")
        if link is not None:
            return self._decide("reject", link, None, author)
        if last is not None and last.action == "reject":
            raise DecisionError(f"link {from_id}->{to_id} is rejected already, by decision {last.id}; undo that first")
        if not self._candidates(from_id, to_id):
            raise DecisionError(f"nodes {from_id} and {to_id} are not linked, and no loop between them was looked at")
        return self._decide("reject", None, None, author, (from_id, to_id))

    def undo(self, author: str = "") -> Effect:
        """Take back the last decision that stands, to the last bit where the map hasn't changed since.

        Raises:
            DecisionError: no decision stands, or the map has changed so that it can't be taken back.
        """
        step = self._history.to_undo()
        entry = _answer("undo", step.entry, step.entry.id, step.entry.link_after, step.entry.link_before, author)
        return self._carry_out(entry, step.here, step.there)

    def redo(self, author: str = "") -> Effect:
        """Do again what was undone last.

        Raises:
            DecisionError: nothing was undone since the last decision, or the map has changed.
        """
        step = self._history.to_redo()
        entry = _answer("redo", step.entry, step.undo_id, step.entry.link_before, step.entry.link_after, author)
        return self._carry_out(entry, step.here, step.there)

    def _decide(
        self, action: str, before: Link | None, after: Link | None, author: str, ids: tuple[int, int] = (0, 0)
    ) -> Effect:
        link = before or after
        from_id, to_id = (link.from_id, link.to_id) if link is not None else ids
        return self._carry_out(
            JournalEntry(
                action=action, from_id=from_id, to_id=to_id, author=author, link_before=before, link_after=after
            )
        )

    def _carry_out(self, entry: JournalEntry, here: Snapshot | None = None, there: Snapshot | None = None) -> Effect:
        """Change graph, file and history, all or none."""
        poses, chi2_before, before = self.graph.poses, self._chi2(), Snapshot.of(self.graph.poses)
        ate_before = self._ate(poses) if self._ate is not None else None
        known = there if here is not None and here.same(poses) else None
        try:
            with self._change(entry, known) as separated:
                shift = Shift.between(poses, self.graph.poses)
                chi2_after = chi2_before if self.graph.poses is poses else self._chi2()
                ate_after = self._ate(self.graph.poses) if self._ate is not None else None
                entry = replace(entry, time=time.time(), chi2_before=chi2_before, chi2_after=chi2_after)
                entry = replace(entry, moved=shift.moved, max_shift_m=shift.max_m)
                entry = replace(entry, id=self._write(entry))
        except OptimizationError as error:
            raise DecisionError(f"{entry.action} {entry.from_id}->{entry.to_id} is not possible: {error}") from error
        self._history.record(entry, before, Snapshot.of(self.graph.poses))
        return Effect(entry, chi2_before, chi2_after, shift.moved, shift.max_m, ate_before, ate_after, separated)

    def _change(self, entry: JournalEntry, there: Snapshot | None) -> AbstractContextManager[int]:
        before, after = entry.link_before, entry.link_after
        if before is None and after is not None:
            return with_link(self.graph, after, self.params, there)
        if before is not None and after is None:
            return without_link(self.graph, before.pair, self.params, there)
        return nullcontext(0)

    def _write(self, entry: JournalEntry) -> int:
        before, after = entry.link_before, entry.link_after
        if (before is None) == (after is None):
            return self._writer.append_decision(entry, poses={})
        add = [after] if after is not None else []
        remove = [(before.from_id, before.to_id)] if before is not None else []
        return self._writer.append_decision(entry, add=add, remove=remove, poses=self.graph.poses)

    def _addable(self, from_id: int, to_id: int, last: JournalEntry | None) -> Link:
        """The link that approving a pair adds: the one that was rejected, else that of the newest candidate."""
        if last is not None and last.action == "reject" and last.link_before is not None:
            return last.link_before
        known = self._candidates(from_id, to_id)
        if not known:
            raise DecisionError(
                f"nodes {from_id} and {to_id}: no loop between them was looked at, so none can be added"
            )
        for item in reversed(known):
            if item.T_from_to is not None and item.information is not None:
                return Link(item.from_id, item.to_id, LinkType.USER_CLOSURE, item.T_from_to, item.information)
        why = known[-1].refusal
        reason = f" ({why.text})" if why is not None else ""
        raise DecisionError(f"loop {from_id}->{to_id} can't be added: its registration found no transform{reason}")

    def _candidates(self, from_id: int, to_id: int) -> list[Candidate]:
        rows = (row.candidate for row in self._reader.candidates())
        return [item for item in rows if _pair(item.from_id, item.to_id) == _pair(from_id, to_id)]

    def _chi2(self) -> float:
        return chi2([self.graph.links[pair] for pair in sorted(self.graph.links)], self.graph.poses)


def _answer(
    action: str, decision: JournalEntry, undoes: int, before: Link | None, after: Link | None, author: str
) -> JournalEntry:
    return JournalEntry(
        action=action,
        from_id=decision.from_id,
        to_id=decision.to_id,
        author=author,
        link_before=before,
        link_after=after,
        undoes=undoes,
    )


def _pair(a: int, b: int) -> tuple[int, int]:
    return min(a, b), max(a, b)
