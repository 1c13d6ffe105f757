"""Shapes of what hangs together in a graph, and of what was tried to join the rest."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import Schema
from server.schemas.links import LoopReason


class NearMiss(Schema):
    """A loop that would have joined two components, and why it did not."""

    from_: int = Field(alias="from")
    to: int
    type: str
    component: int
    """The other one."""
    posterior: float | None
    matches: int | None
    inliers: int | None
    reason: LoopReason | None
    removed: bool
    """It was in the graph once and was taken out."""


class BestGuess(Schema):
    """The strongest hypothesis that a node of one component was a place of another one."""

    node: int
    place: int
    value: float
    threshold: float
    """``Rtabmap/LoopThr``: below it nothing is tried."""


class Component(Schema):
    """Nodes that links or landmarks join."""

    id: int
    """Its oldest node."""
    nodes: int
    newest: int
    sessions: list[int]
    tried: int
    """Loops with other components that were looked at and refused."""
    near_misses: list[NearMiss]
    """The best of them."""
    guess: BestGuess | None
    """Where nothing was tried: what came nearest to it."""


class Components(Schema):
    """The components of a map, the largest first."""

    components: list[Component]
    count: int
    """Of all; no more than a hundred are listed."""
