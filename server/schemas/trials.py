"""Shapes of trials: a map replayed with other parameters, beside its replay as it was."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from server.schemas.base import ParameterValue, PoseList, Schema
from server.schemas.parameters import ParameterSet


class TrialChange(Schema):
    """A parameter that is tried."""

    name: str
    before: ParameterValue
    value: ParameterValue


class Trial(Schema):
    """A trial of a map, under way or done."""

    number: int
    state: Literal["running", "done", "failed"]
    share: float
    """How much of it is done, 0 to 1."""
    text: str
    """What is being done, or why it failed."""
    changes: list[TrialChange]
    started: float
    """Seconds since 1970."""
    seconds: float
    """That it took."""
    stale: bool
    """Whether the map has changed since: its outcome is that of the map as it was then."""


class Trials(Schema):
    """The trials of a map, the newest first."""

    trials: list[Trial]


class StartTrial(Schema):
    """Parameters to try, by name."""

    changes: dict[str, ParameterValue] = Field(min_length=1)


class TrialLoop(Schema):
    """A loop that one of two replays lacks."""

    key: str
    """Both ids in this map, newer first, ``147-61``."""
    type: str
    reason: str
    """Why the other one does not have it; empty where it never came to be tried."""
    known: bool
    """Whether this map's review queue has it."""


class TrialSide(Schema):
    """What came of one run; null where its file does not say."""

    nodes: int
    sessions: int
    loops: dict[str, int]
    """By the name of their type."""
    loops_total: int
    refused: int
    """Pairs that were tried and are no loop."""
    ate_m: float | None
    path_m: float
    median_ms: float | None
    """Of the updates."""
    p95_ms: float | None
    max_ms: float | None
    wm_max: int | None
    """Most nodes in working memory."""
    stm_max: int | None
    ltm_end: int | None
    retrieved: int | None
    transferred: int | None
    update_ids: list[int]
    """Nodes of the updates, by their ids in this map; the next two have a value for each."""
    update_ms: list[float | None]
    wm: list[float | None]
    ids: list[int]
    """Nodes of this map that have a pose."""
    poses: list[PoseList]
    loop_pairs: list[list[int]]
    """Both ids of each loop."""


class TrialComparison(Schema):
    """Both sides of a trial, and the map as it was made."""

    original: TrialSide
    baseline: TrialSide
    """Replayed with its own parameters, from the same stored key points: what the trial is compared with."""
    tried: TrialSide
    came: list[TrialLoop]
    gone: list[TrialLoop]
    unlike: int
    """Loops that either the map or its replay as it was has."""
    drift_m: float
    """The farthest that a node of the replay as it was is from where the map has it."""
    moved: int
    """Poses that differ between both replays by more than 1 mm or 0.05 deg."""
    max_shift_m: float
    images: str
    """Why images had to be decoded; empty where stored key points were enough."""


class TrialOutcome(Schema):
    """A trial with what came of it."""

    trial: Trial
    comparison: TrialComparison | None
    """Null while it runs, and when it failed."""


class TakenOver(Schema):
    """What became of parameters that were taken over."""

    parameters: ParameterSet
    applied: list[str]
    left: list[str]
    """Those that a running engine can't change: they need a session of their own."""


class KeepTrial(Schema):
    """The name of a new map file in the first served folder, without ``.db``."""

    name: str = Field(min_length=1, max_length=200, pattern=r"^[\w][\w.\-]*$")


class KeptTrial(Schema):
    """The map that was made of a trial."""

    map: str
