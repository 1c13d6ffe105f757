"""What people say of loops, as entries of the journal; nothing is changed by making them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from slam.database.records import JournalEntry
from slam.errors import DecisionError
from slam.graph.graph import PoseGraph, name
from slam.history import History, Step
from slam.types import Candidate, Link, LinkType

#: What is said of a loop.
Verdict = Literal["approve", "reject"]
#: What was looked at, by both ids, smaller first; of each pair the newest last.
Rows = Mapping[tuple[int, int], Sequence[Candidate]]


def approval(graph: PoseGraph, history: History, rows: Rows, ids: tuple[int, int], author: str) -> JournalEntry:
    """Of a loop that is true: marks one that is in the graph, adds one that was refused or rejected.

    Raises:
        DecisionError: it is no loop, is approved already, or has no transform that could be added.
    """
    link, last = graph.links.get(ordered(*ids)), history.last(ordered(*ids))
    if link is None:
        return _entry("add", None, _addable(*ids, last, rows), author)
    if not link.type.is_loop:
        raise DecisionError(f"link {name(link)} is no loop: only loop closures are approved or rejected")
    if last is not None and last.action in ("approve", "add"):
        raise DecisionError(f"link {name(link)} is approved already, by decision {last.id}; undo that first")
    return _entry("approve", link, link, author)


def rejection(graph: PoseGraph, history: History, rows: Rows, ids: tuple[int, int], author: str) -> JournalEntry:
    """Of a loop that is false: removes one that is in the graph, marks one that was refused.

    Raises:
        DecisionError: it is odometry, is rejected already, or unknown.
    """
    (from_id, to_id), pair = ids, ordered(*ids)
    link, last = graph.links.get(pair), history.last(pair)
    if link is not None and not link.type.is_loop:
        raise DecisionError(f"link {name(link)} is odometry and can't be rejected: the path would come apart")
    if link is not None:
        return _entry("reject", link, None, author)
    if last is not None and last.action == "reject":
        raise DecisionError(f"link {from_id}->{to_id} is rejected already, by decision {last.id}; undo that first")
    if pair not in rows:
        raise DecisionError(f"nodes {from_id} and {to_id} are not linked, and no loop between them was looked at")
    return JournalEntry(action="reject", from_id=from_id, to_id=to_id, author=author)


def undoing(step: Step, author: str) -> JournalEntry:
    """The entry that takes a decision back."""
    return _answer("undo", step.entry, step.entry.id, step.entry.link_after, step.entry.link_before, author)


def redoing(step: Step, author: str) -> JournalEntry:
    """The entry that makes a decision again that was taken back."""
    return _answer("redo", step.entry, step.undo_id, step.entry.link_before, step.entry.link_after, author)


def ordered(a: int, b: int) -> tuple[int, int]:
    """Both ids, smaller first."""
    return min(a, b), max(a, b)


def _addable(from_id: int, to_id: int, last: JournalEntry | None, rows: Rows) -> Link:
    """The link that approving a pair adds: the one that was rejected, else that of the newest candidate."""
    if last is not None and last.action == "reject" and last.link_before is not None:
        return last.link_before
    known = rows.get(ordered(from_id, to_id))
    if not known:
        raise DecisionError(f"nodes {from_id} and {to_id}: no loop between them was looked at, so none can be added")
    for item in reversed(known):
        if item.T_from_to is not None and item.information is not None:
            return Link(item.from_id, item.to_id, LinkType.USER_CLOSURE, item.T_from_to, item.information)
    why = known[-1].refusal
    reason = f" ({why.text})" if why is not None else ""
    raise DecisionError(f"loop {from_id}->{to_id} can't be added: its registration found no transform{reason}")


def _entry(action: str, before: Link | None, after: Link | None, author: str) -> JournalEntry:
    link = before or after
    assert link is not None
    return JournalEntry(
        action=action, from_id=link.from_id, to_id=link.to_id, author=author, link_before=before, link_after=after
    )


def _answer(
    action: str, decision: JournalEntry, undoes: int, before: Link | None, after: Link | None, author: str
) -> JournalEntry:
    node, setting, placement, grids = decision.node, decision.setting, decision.placement, decision.grids
    return JournalEntry(
        action=action,
        from_id=decision.from_id,
        to_id=decision.to_id,
        author=author,
        link_before=before,
        link_after=after,
        note="" if placement is None and grids is None else decision.note,
        undoes=undoes,
        node=node if node is None or action == "redo" else node.reversed(),
        setting=setting if setting is None or action == "redo" else setting.reversed(),
        placement=placement if placement is None or action == "redo" else placement.reversed(),
        grids=None if grids is None else grids.kept(decision.id),
    )
