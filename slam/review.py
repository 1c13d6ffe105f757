"""People's decisions about a map: verdicts on loops, edits, undo and redo, each with what it did to the map."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import Protocol

from slam.database.records import JournalEntry
from slam.effect import Effect, Unsaid, with_effect
from slam.errors import DecisionError, OptimizationError
from slam.geometry import Pose
from slam.graph.course import placed
from slam.graph.exchange import exchanged
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import chi2
from slam.graph.shift import Shift, Snapshot
from slam.history import History, Step
from slam.params import Params
from slam.types import Candidate, Link
from slam.verdicts import Rows, Verdict, approval, ordered, redoing, rejection, undoing
from slam.wanted_changes import joins, links_of, named, nodes_of, placement_of

#: Poses (id -> T_map_base) -> absolute trajectory error in metres, None without ground truth.
Ate = Callable[[Mapping[int, Pose]], float | None]
_DONE = {"approve": "approved", "reject": "rejected"}


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

    def poses_before(self, number: int) -> Mapping[int, Pose] | None:
        """Id -> pose before the decision whose first entry is ``number``, None unless it left the poses of now."""
        ...


class DecisionWriter(Protocol):
    """What a review asks of the one writer of a map file."""

    def append_decisions(
        self,
        entries: Sequence[JournalEntry],
        *,
        add: Sequence[Link] = (),
        remove: Sequence[tuple[int, int]] = (),
        poses: Mapping[int, Pose],
        candidates: Sequence[Candidate] = (),
    ) -> list[int]:
        """Write journal, links and optimised poses in one transaction; returns the entries' numbers."""
        ...


class Review:
    """Decisions about the loops of one map; each is journalled, and each can be undone, after a restart too.

    Attributes:
        graph: the map's graph, which decisions change.
        params: for optimising it; replace it when a parameter has changed.
    """

    def __init__(
        self,
        graph: PoseGraph,
        writer: DecisionWriter,
        reader: DecisionReader,
        params: Params,
        ate: Ate | None = None,
        *,
        nodes_stay: bool = False,
    ) -> None:
        self.graph = graph
        self.params = params
        self._writer = writer
        self._reader = reader
        self._ate = ate
        # While a map is made its engine's memory holds the nodes: none comes or goes, by undo or redo neither.
        self._nodes_stay = nodes_stay
        self._history = History(reader.journal())

    def approve(self, from_id: int, to_id: int, author: str = "") -> Effect:
        """Say that a loop is true: marks one that is in the graph, adds one that was refused or rejected.

        Raises:
            DecisionError: it is no loop, is approved already, or has no transform that could be added.
        """
        return self.decide("approve", [(from_id, to_id)], author)

    def reject(self, from_id: int, to_id: int, author: str = "") -> Effect:
        """Say that a loop is false: removes one that is in the graph, marks one that was refused.

        Raises:
            DecisionError: it is odometry, is rejected already, or unknown.
        """
        return self.decide("reject", [(from_id, to_id)], author)

    def decide(
        self,
        action: Verdict,
        loops: Sequence[tuple[int, int]],
        author: str = "",
        *,
        preview: bool = False,
        tried: Sequence[Candidate] = (),
    ) -> Effect:
        """Approve or reject several loops together: one optimisation, one transaction, and one undo takes all back.

        Args:
            action: what is said of each of them.
            loops: both ids of each, in any order; those that it can't be said of are left out, and named in the effect.
            author: who decides.
            preview: only work out what it would do; nothing is changed or written.
            tried: loops that were looked at elsewhere: where the map knows nothing of theirs they are kept with it.

        Raises:
            DecisionError: it can't be said of any of them, or there is no solution.
        """
        entries, refused, rows = [], [], dict(self._looked_at())
        new = [one for one in tried if ordered(one.from_id, one.to_id) not in rows]
        rows |= {ordered(one.from_id, one.to_id): [one] for one in new}
        verdict = {"approve": approval, "reject": rejection}[action]
        for ids in {ordered(*ids): ids for ids in loops}.values():
            try:
                entries.append(verdict(self.graph, self._history, rows, ids, author))
            except DecisionError as error:
                refused.append(Unsaid(*ids, str(error)))
        if not entries:
            raise DecisionError(_nothing(action, refused))
        said = {entry.pair for entry in entries}
        kept = [one for one in new if ordered(one.from_id, one.to_id) in said]
        return self._carry_out(entries, refused=tuple(refused), preview=preview, candidates=kept)

    def change(
        self, entries: Sequence[JournalEntry], *, candidates: Sequence[Candidate] = (), preview: bool = False
    ) -> Effect:
        """Carry out edits of links and nodes together: one optimisation, one transaction, one undo.

        Args:
            entries: what is to be done; numbers, time and effect are filled in.
            candidates: loops that were looked at for them, to be kept with the others.
            preview: only work out what it would do.

        Raises:
            DecisionError: it is not possible on this graph.
            DatabaseError: it can't be written.
        """
        if not entries:
            raise DecisionError("nothing to change: no link and no node is named")
        return self._carry_out(entries, preview=preview, candidates=candidates)

    def keep(self, candidates: Sequence[Candidate]) -> None:
        """Keep loops that were looked at and changed nothing."""
        self._writer.append_decisions((), poses={}, candidates=candidates)

    def original(self, pair: tuple[int, int]) -> Link | None:
        """The link of a pair (smaller id first) before people edited it; None where they did not."""
        return self._history.original(pair)

    def undo(self, author: str = "", *, preview: bool = False) -> Effect:
        """Take back the last decision that stands, to the last bit where the map hasn't changed since.

        After a restart the poses are those that the file had, to the last bit too. Decisions made together are taken
        back together.

        Raises:
            DecisionError: no decision stands, or the map has changed so that it can't be taken back.
        """
        steps = self._history.to_undo()
        return self._carry_out([undoing(step, author) for step in steps], steps, preview=preview)

    def redo(self, author: str = "", *, preview: bool = False) -> Effect:
        """Do again what was undone last.

        Raises:
            DecisionError: nothing was undone since the last decision, or the map has changed.
        """
        steps = self._history.to_redo()
        return self._carry_out([redoing(step, author) for step in steps], steps, preview=preview)

    def _carry_out(
        self,
        entries: Sequence[JournalEntry],
        steps: Sequence[Step] = (),
        refused: tuple[Unsaid, ...] = (),
        *,
        preview: bool = False,
        candidates: Sequence[Candidate] = (),
    ) -> Effect:
        """Change graph, file and history, all or none; a preview changes none of them."""
        if self._nodes_stay:
            _require_that_nodes_stay(entries)
        poses, before = self.graph.poses, Snapshot.of(self.graph.poses)
        known, params = self._there(steps, entries), self._params_of(entries)
        was = self._chi2(), self._ate_at(poses)
        try:
            with self._change(entries, params, known or self._placed(entries, params), keep=not preview) as separated:
                now = was if self.graph.poses is poses else (self._chi2(), self._ate_at(self.graph.poses))
                effect = _effect(was, now, Shift.between(poses, self.graph.poses), separated, refused, preview=preview)
                entries = [with_effect(entry, effect) for entry in entries]
                if not preview:
                    entries = self._write(entries, candidates)
        except OptimizationError as error:
            what = f"{entries[0].action} {named(entries)}"
            raise DecisionError(f"{what} is not possible: {error}") from error
        if not preview:
            self.params = params
            after = Snapshot.of(self.graph.poses)
            for entry in entries:
                self._history.record(entry, before, after)
        return replace(effect, entries=tuple(entries))

    def _there(self, steps: Sequence[Step], entries: Sequence[JournalEntry]) -> Snapshot | None:
        """The poses that undo or redo leads to: as they are remembered, else as the file has them; None without."""
        if not steps:
            return None
        step = steps[0]
        if step.here is not None and step.here.same(self.graph.poses):
            return step.there
        stored = self._reader.poses_before(min(one.undo_id or one.entry.id for one in steps))
        restore, drop = nodes_of(entries)
        ids = [i for i in (*self.graph.poses, *(node.node_id for node in restore)) if i not in drop]
        if stored is None or any(i not in stored for i in ids):
            return None
        return Snapshot.of({i: stored[i] for i in ids})

    def _placed(self, entries: Sequence[JournalEntry], params: Params) -> Snapshot | None:
        """The poses that a placement leads to; None where the entries are none."""
        placement = placement_of(entries)
        return None if placement is None else Snapshot.of(placed(self.graph, params, placement))

    def _params_of(self, entries: Sequence[JournalEntry]) -> Params:
        """The parameters that hold once these entries are carried out."""
        changes = {entry.setting.name: entry.setting.after for entry in entries if entry.setting is not None}
        return self.params.changed(changes) if changes else self.params

    def _change(
        self, entries: Sequence[JournalEntry], params: Params, there: Snapshot | None, *, keep: bool
    ) -> AbstractContextManager[int]:
        (add, remove), (restore, drop) = links_of(entries), nodes_of(entries)
        if not (add or remove or restore or drop or placement_of(entries)):
            return nullcontext(0)
        return exchanged(
            self.graph,
            [link.pair for link in remove if joins(link)],
            [link for link in add if joins(link)],
            params,
            there,
            keep=keep,
            drop=drop,
            restore=restore,
            release=[link for link in remove if not joins(link)],
            hold=[link for link in add if not joins(link)],
        )

    def _write(self, entries: Sequence[JournalEntry], candidates: Sequence[Candidate]) -> list[JournalEntry]:
        (add, remove), (restore, drop) = links_of(entries), nodes_of(entries)
        gone = [(link.from_id, link.to_id) for link in remove]
        poses = self.graph.poses if add or remove or restore or drop or placement_of(entries) else {}
        numbers = self._writer.append_decisions(entries, add=add, remove=gone, poses=poses, candidates=candidates)
        batch = numbers[0] if len(numbers) > 1 else None
        return [
            replace(entry, id=k, batch=batch, grids=None if entry.grids is None else entry.grids.kept(k))
            for entry, k in zip(entries, numbers, strict=True)
        ]

    def _looked_at(self) -> Rows:
        rows: dict[tuple[int, int], list[Candidate]] = {}
        for row in self._reader.candidates():
            rows.setdefault(ordered(row.candidate.from_id, row.candidate.to_id), []).append(row.candidate)
        return rows

    def _chi2(self) -> float:
        return chi2([self.graph.links[pair] for pair in sorted(self.graph.links)], self.graph.poses)

    def _ate_at(self, poses: Mapping[int, Pose]) -> float | None:
        return None if self._ate is None else self._ate(poses)


def _require_that_nodes_stay(entries: Sequence[JournalEntry]) -> None:
    """Raises DecisionError for what the engine that makes the map could not follow."""
    what = f"{entries[0].action} {named(entries)}"
    if any(nodes_of(entries)):
        raise DecisionError(
            f"{what} would move nodes in or out of the map, which the engine that makes it holds in its memory: stop"
            " the run first"
        )
    if placement_of(entries) is not None:
        raise DecisionError(
            f"{what} would not last: the engine that makes the map optimises it anew with the next loop. Stop the run"
            " first"
        )
    if any(entry.grids is not None for entry in entries):
        raise DecisionError(
            f"{what} would change local grids, which the engine that makes the map holds in its floor plan: stop the"
            " run first"
        )


def _nothing(action: Verdict, refused: Sequence[Unsaid]) -> str:
    if not refused:
        return f"nothing to {action}: no loop is named"
    if len(refused) == 1:
        return refused[0].reason
    return f"none of these {len(refused)} loops can be {_DONE[action]}; the first: {refused[0].reason}"


def _effect(
    was: tuple[float, float | None],
    now: tuple[float, float | None],
    shift: Shift,
    separated: int,
    refused: tuple[Unsaid, ...],
    *,
    preview: bool,
) -> Effect:
    return Effect((), was[0], now[0], shift.moved, shift.max_m, was[1], now[1], separated, refused, preview)
