"""Shapes of people's decisions."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from server.schemas.base import Schema

DecisionAction = Literal["approve", "reject", "undo", "redo"]


class Decision(Schema):
    """What to do about a loop; ``undo`` and ``redo`` take no ids."""

    action: DecisionAction
    from_: int | None = Field(None, alias="from")
    to: int | None = None

    @model_validator(mode="after")
    def _has_ids(self) -> Decision:
        if self.action in ("approve", "reject") and (self.from_ is None or self.to is None):
            raise ValueError(f"{self.action} needs both ids of the link: from and to")
        return self


class DecisionEffect(Schema):
    """What a decision did to the map."""

    chi2_before: float | None
    chi2_after: float | None
    moved: int
    """Poses that moved by more than 1 mm or 0.05 deg."""
    max_shift_m: float
    ate_before_m: float | None
    ate_after_m: float | None


class JournalEntry(Schema):
    """One decision in the journal."""

    id: int
    time: float
    """Unix seconds."""
    author: str
    action: str
    from_id: int
    to_id: int
    note: str
    undone_by: int | None
    effect: DecisionEffect


class DecisionResult(Schema):
    """The decision as it was journalled, and the graph's new revision."""

    entry: JournalEntry
    effect: DecisionEffect
    revision: int


class Journal(Schema):
    """All decisions, oldest first."""

    entries: list[JournalEntry]
