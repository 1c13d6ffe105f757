"""People's decisions, and what they did."""

from __future__ import annotations

from collections.abc import Sequence

from server.browse.columns import number
from server.schemas import Changes, DecisionEffect, DecisionResult, JournalEntry, RefusedDecision
from slam.database import JournalEntry as StoredEntry
from slam.effect import Effect
from slam.types import LinkType


def decision_result(effect: Effect, revision: int | None, note: str = "") -> DecisionResult:
    """What a decision did, as the page gets it; without a revision what it would do."""
    entry = journal_entry(effect.entry)
    return DecisionResult(
        entry=entry,
        count=len(effect.entries),
        refused=[RefusedDecision(from_=one.from_id, to=one.to_id, reason=one.reason) for one in effect.refused],
        effect=entry.effect.model_copy(update={"separated": effect.separated}),
        changes=_changes(effect.entries),
        note=note,
        preview=effect.preview,
        revision=revision,
    )


def _changes(entries: Sequence[StoredEntry]) -> Changes:
    pairs = [(e.link_before, e.link_after) for e in entries]
    new = [after for before, after in pairs if before is None and after is not None]
    gone = [before for before, after in pairs if before is not None and after is None]
    nodes = [entry.node for entry in entries if entry.node is not None]
    loops_new, loops_gone = (sum(link.type.is_loop for link in links) for links in (new, gone))
    priors_new, priors_gone = (sum(link.type is LinkType.POSE_PRIOR for link in links) for links in (new, gone))
    return Changes(
        nodes_gone=sum(node.drops for node in nodes),
        nodes_back=sum(node.restores for node in nodes),
        links_gone=len(gone) - loops_gone - priors_gone,
        links_new=len(new) - loops_new - priors_new,
        loops_gone=loops_gone,
        loops_new=loops_new,
        priors_gone=priors_gone,
        priors_new=priors_new,
        changed=sum(before is not None and after is not None and before is not after for before, after in pairs),
    )


def journal_entry(entry: StoredEntry) -> JournalEntry:
    """An entry of the journal as the page gets it."""
    return JournalEntry(
        id=entry.id,
        time=entry.time,
        author=entry.author,
        action=entry.action,
        from_id=entry.from_id,
        to_id=entry.to_id,
        note=entry.note,
        of_map=entry.placement is not None or entry.grids is not None,
        undone_by=entry.undone_by,
        batch=entry.batch,
        effect=DecisionEffect(
            chi2_before=number(entry.chi2_before),
            chi2_after=number(entry.chi2_after),
            moved=entry.moved,
            max_shift_m=entry.max_shift_m,
            ate_before_m=number(entry.ate_before),
            ate_after_m=number(entry.ate_after),
        ),
    )
