"""Shapes of people's decisions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from server.schemas.base import Pair, Schema

DecisionAction = Literal["approve", "reject", "undo", "redo"]


#: More than any person decides about at once.
_MOST = 10_000
_Author = Annotated[str, Field(max_length=80)]


class Decision(Schema):
    """What to do about a loop, or about several together; ``undo`` and ``redo`` take no ids."""

    action: DecisionAction
    from_: int | None = Field(None, alias="from")
    to: int | None = None
    loops: list[Pair] = Field(default_factory=list, max_length=_MOST)
    """Both ids of each loop, in place of ``from`` and ``to``: decided together, undone together."""
    author: _Author = ""
    """Who decides, for the journal."""
    preview: bool = False
    """Only say what it would do."""

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Both ids of each loop that it is about."""
        if self.from_ is not None and self.to is not None:
            return ((self.from_, self.to),)
        return tuple((a, b) for a, b in self.loops)

    @model_validator(mode="after")
    def _has_ids(self) -> Decision:
        both = (self.from_, self.to).count(None)
        if both == 1 or (both == 0 and self.loops):
            raise ValueError("name one loop by from and to, or several by loops")
        if self.action in ("approve", "reject") and not self.pairs:
            raise ValueError(f"{self.action} needs both ids of the link, from and to, or loops")
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
    separated: int | None = None
    """Nodes that lost their way to the oldest node of their graph; the journal does not keep it."""


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
    of_map: bool
    """Whether it is about the poses of the whole map, and not about a link or a node."""
    undone_by: int | None
    batch: int | None
    """Id of the first entry of those that were decided together, and had this effect together."""
    effect: DecisionEffect


class Changes(Schema):
    """What comes, goes and changes by decisions made together."""

    nodes_gone: int
    nodes_back: int
    links_gone: int
    """Between two nodes; loops are counted on their own."""
    links_new: int
    loops_gone: int
    loops_new: int
    priors_gone: int
    priors_new: int
    changed: int
    """Links, priors and sightings whose numbers change."""


class RefusedDecision(Schema):
    """A loop that was named and left as it is."""

    from_: int = Field(alias="from")
    to: int
    reason: str


class DecisionResult(Schema):
    """The decisions as they were journalled, and the graph's new revision."""

    entry: JournalEntry
    """The first of them; of a preview what would be written."""
    count: int
    """Loops that it was about."""
    refused: list[RefusedDecision]
    effect: DecisionEffect
    changes: Changes
    note: str = ""
    """What else must be known of it, such as a parameter that keeps it from having an effect."""
    preview: bool
    revision: int | None
    """None after a preview."""


class Journal(Schema):
    """All decisions, oldest first."""

    entries: list[JournalEntry]
