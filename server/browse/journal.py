"""People's decisions."""

from __future__ import annotations

from server.browse.columns import number
from server.schemas import DecisionEffect, JournalEntry
from slam.database import JournalEntry as StoredEntry


def journal_entry(entry: StoredEntry) -> JournalEntry:
    """An entry of the journal as the page gets it; the trajectory error of old entries isn't stored."""
    return JournalEntry(
        id=entry.id,
        time=entry.time,
        author=entry.author,
        action=entry.action,
        from_id=entry.from_id,
        to_id=entry.to_id,
        note=entry.note,
        undone_by=entry.undone_by,
        effect=DecisionEffect(
            chi2_before=number(entry.chi2_before),
            chi2_after=number(entry.chi2_after),
            moved=entry.moved,
            max_shift_m=entry.max_shift_m,
            ate_before_m=None,
            ate_after_m=None,
        ),
    )
