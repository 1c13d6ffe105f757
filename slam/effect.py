"""What a decision did to a map, or would do."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from slam.database.records import JournalEntry


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


def with_effect(entry: JournalEntry, effect: Effect) -> JournalEntry:
    """The entry as it is carried out now, with what that did."""
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
