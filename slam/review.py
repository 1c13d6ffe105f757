"""People's decisions about a map: verdicts on loops, edits, undo and redo, each with what it did to the map."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from slam.database.records import JournalEntry
from slam.errors import DecisionError, OptimizationError
from slam.geometry import Pose
from slam.graph.course import placed
from slam.graph.exchange import GraphNode, exchanged
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import chi2
from slam.graph.shift import Shift, Snapshot
from slam.history import History, Step
from slam.params import Params
from slam.types import Candidate, Link, LinkType, Placement
from slam.verdicts import Rows, Verdict, approval, ordered, redoing, rejection, undoing

#: Poses (id -> T_map_base) -> absolute trajectory error in metres, None without ground truth.
Ate = Callable[[Mapping[int, Pose]], float | None]
#: Of many decisions that are made together so many are named.
_NAMED = 5
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


@dataclass(frozen=True, slots=True)
class Unsaid:
    """A loop that a decision could not be made about, and why."""

    from_id: int
    to_id: int
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """What a decision did, or would do.

    Attributes:
        entries: the journal's entries, one for each loop.
        chi2_before: sum of squared, whitened residuals of all links before.
        chi2_after: the same after.
        moved: poses that moved by more than 1 mm or 0.05 deg.
        max_shift_m: the farthest that one moved, metres.
        ate_before: absolute trajectory error in metres before, None without ground truth.
        ate_after: the same after.
        separated: nodes that lost their way to the oldest node of their graph.
        refused: loops that were named and left as they are.
        preview: whether nothing was changed.
    """

    entries: tuple[JournalEntry, ...]
    chi2_before: float
    chi2_after: float
    moved: int
    max_shift_m: float
    ate_before: float | None
    ate_after: float | None
    separated: int
    refused: tuple[Unsaid, ...] = ()
    preview: bool = False

    @property
    def entry(self) -> JournalEntry:
        """The first entry."""
        return self.entries[0]


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
        if self._nodes_stay and any(_nodes(entries)):
            raise DecisionError(
                f"{entries[0].action} {_named(entries)} would move nodes in or out of the map, which the engine that"
                " makes it holds in its memory: stop the run first"
            )
        if self._nodes_stay and _placement(entries) is not None:
            raise DecisionError(
                f"{entries[0].action} {_named(entries)} would not last: the engine that makes the map optimises it anew"
                " with the next loop. Stop the run first"
            )
        if self._nodes_stay and any(entry.grids is not None for entry in entries):
            raise DecisionError(
                f"{entries[0].action} {_named(entries)} would change local grids, which the engine that makes the map"
                " holds in its floor plan: stop the run first"
            )
        poses, before = self.graph.poses, Snapshot.of(self.graph.poses)
        known, params = self._there(steps, entries), self._params_of(entries)
        was = self._chi2(), self._ate_at(poses)
        try:
            with self._change(entries, params, known or self._placed(entries, params), keep=not preview) as separated:
                now = was if self.graph.poses is poses else (self._chi2(), self._ate_at(self.graph.poses))
                effect = _effect(was, now, Shift.between(poses, self.graph.poses), separated, refused, preview=preview)
                entries = [_with_effect(entry, effect) for entry in entries]
                if not preview:
                    entries = self._write(entries, candidates)
        except OptimizationError as error:
            what = f"{entries[0].action} {_named(entries)}"
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
        restore, drop = _nodes(entries)
        ids = [i for i in (*self.graph.poses, *(node.node_id for node in restore)) if i not in drop]
        if stored is None or any(i not in stored for i in ids):
            return None
        return Snapshot.of({i: stored[i] for i in ids})

    def _placed(self, entries: Sequence[JournalEntry], params: Params) -> Snapshot | None:
        """The poses that a placement leads to; None where the entries are none."""
        placement = _placement(entries)
        return None if placement is None else Snapshot.of(placed(self.graph, params, placement))

    def _params_of(self, entries: Sequence[JournalEntry]) -> Params:
        """The parameters that hold once these entries are carried out."""
        changes = {entry.setting.name: entry.setting.after for entry in entries if entry.setting is not None}
        return self.params.changed(changes) if changes else self.params

    def _change(
        self, entries: Sequence[JournalEntry], params: Params, there: Snapshot | None, *, keep: bool
    ) -> AbstractContextManager[int]:
        (add, remove), (restore, drop) = _links(entries), _nodes(entries)
        if not (add or remove or restore or drop or _placement(entries)):
            return nullcontext(0)
        return exchanged(
            self.graph,
            [link.pair for link in remove if _joins(link)],
            [link for link in add if _joins(link)],
            params,
            there,
            keep=keep,
            drop=drop,
            restore=restore,
            release=[link for link in remove if not _joins(link)],
            hold=[link for link in add if not _joins(link)],
        )

    def _write(self, entries: Sequence[JournalEntry], candidates: Sequence[Candidate]) -> list[JournalEntry]:
        (add, remove), (restore, drop) = _links(entries), _nodes(entries)
        gone = [(link.from_id, link.to_id) for link in remove]
        poses = self.graph.poses if add or remove or restore or drop or _placement(entries) else {}
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


def _nothing(action: Verdict, refused: Sequence[Unsaid]) -> str:
    if not refused:
        return f"nothing to {action}: no loop is named"
    if len(refused) == 1:
        return refused[0].reason
    return f"none of these {len(refused)} loops can be {_DONE[action]}; the first: {refused[0].reason}"


def _links(entries: Sequence[JournalEntry]) -> tuple[list[Link], list[Link]]:
    """Links that these entries put into the graph, and those that they take out."""
    changes = [e for e in entries if _is_prior(e) or not _same(e.link_before, e.link_after)]
    return [e.link_after for e in changes if e.link_after], [e.link_before for e in changes if e.link_before]


def _is_prior(entry: JournalEntry) -> bool:
    """A prior that is given again as it was is one that parameters have let in: the poses must follow."""
    return any(k is not None and k.type is LinkType.POSE_PRIOR for k in (entry.link_before, entry.link_after))


def _joins(link: Link) -> bool:
    """Whether a link is one of two nodes, and no prior or sighting of a landmark."""
    return link.to_id > 0 and link.from_id != link.to_id


def _same(a: Link | None, b: Link | None) -> bool:
    if a is None or b is None or a.T_from_to is None or b.T_from_to is None:
        return a is b
    return (
        a.type is b.type and np.array_equal(a.T_from_to, b.T_from_to) and np.array_equal(a.information, b.information)
    )


def _nodes(entries: Sequence[JournalEntry]) -> tuple[list[GraphNode], list[int]]:
    """Nodes that these entries put into the graph, and ids of those that they take out."""
    changes = [entry.node for entry in entries if entry.node is not None]
    restore = [
        GraphNode(n.node_id, n.map_id, n.T_odom_base, n.T_map_base, n.constraints) for n in changes if n.restores
    ]
    return restore, [n.node_id for n in changes if n.drops]


def _placement(entries: Sequence[JournalEntry]) -> Placement | None:
    """What these entries do to all poses; such a decision is made alone."""
    return next((entry.placement for entry in entries if entry.placement is not None), None)


def _named(entries: Sequence[JournalEntry]) -> str:
    if _placement(entries) is not None:
        return "the map"
    named = [f"{e.from_id}->{e.to_id}" if e.from_id != e.to_id else f"node {e.from_id}" for e in entries[:_NAMED]]
    return ", ".join([*named, f"and {len(entries) - _NAMED} more"] if len(entries) > _NAMED else named)


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


def _with_effect(entry: JournalEntry, effect: Effect) -> JournalEntry:
    return replace(
        entry,
        time=time.time(),
        chi2_before=effect.chi2_before,
        chi2_after=effect.chi2_after,
        moved=effect.moved,
        max_shift_m=effect.max_shift_m,
        ate_before=effect.ate_before,
        ate_after=effect.ate_after,
    )
