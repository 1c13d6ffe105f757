"""Shapes of what another threshold would mean."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import PoseList, Schema
from slam.loop.foresight import Outcome


class WhatIfLoop(Schema):
    """A hypothesis that matters at this threshold."""

    key: str
    """Both ids, newer first, ``147-61``."""
    from_: int = Field(alias="from")
    to: int
    value: float
    """What the threshold is compared with."""
    outcome: Outcome
    inliers: int | None
    reason: str
    """Why it would be refused; empty otherwise."""
    true: bool | None
    """What ground truth or a person says of it."""


class WhatIfGraph(Schema):
    """Where the nodes would be."""

    ids: list[int]
    poses: list[PoseList]
    moved: int
    """Poses that would move by more than 1 mm or 0.05 deg."""
    max_shift_m: float
    ate_m: float | None
    stored_off_m: float
    """How far the stored poses are from the optimum of the graph as it is, with which all this is compared."""


class LoopWhatIf(Schema):
    """The map's loops at another ``Rtabmap/LoopThr``, by what each update believed."""

    threshold: float
    in_force: float
    loops: list[WhatIfLoop]
    counts: dict[str, int]
    """By outcome."""
    pending: int
    """Hypotheses that are still being tried; ask again."""
    precision: float | None
    """Of the loops that would be in the map and have a label, the share of true ones."""
    recall: float | None
    """Of the true ones that are known, the share that would be in the map."""
    ate_now_m: float | None
    """Trajectory error of the map as it is: at its optimum where ``graph`` is asked for, else at the stored poses."""
    graph: WhatIfGraph | None
    """None while hypotheses are being tried, or where it was not asked for."""
