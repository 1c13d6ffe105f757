"""Shapes of the run."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from server.schemas.base import ParameterValue, RunState, Schema

SessionCommand = Literal["pause", "resume", "step", "stop"]


class Session(Schema):
    """What the engine does."""

    map: str | None
    state: RunState
    frame: int
    """Frames processed so far."""
    frames: int | None
    nodes: int
    fps: float
    ate_m: float | None
    lost: int
    """Frames that odometry could not track."""
    message: str
    source: str | None
    speed: float
    """Times real time; 0 is as fast as possible."""


RunMode = Literal["new", "append", "localize"]


class StartRun(Schema):
    """A source to map, or to localise in a map."""

    source: str
    """``tour:`` with options, or a TUM folder under an allowed root."""
    map: str = Field(min_length=1, max_length=300, pattern=r"^[\w][\w.\-~ ]*$")
    """Name of the new file in the first served folder, without ``.db``; otherwise the id of a map that is there."""
    mode: RunMode = "new"
    """Make a new map, add a session to one, or localise in one, which keeps it as it is."""
    params: dict[str, ParameterValue] = Field(default_factory=dict)
    speed: float = Field(0.0, ge=0, le=100)
    seed: int = Field(0, ge=0)
