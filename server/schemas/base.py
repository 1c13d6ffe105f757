"""What all shapes of the API share."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from slam.types import Tier

#: x y z in metres, then the quaternion x y z w.
PoseList = Annotated[list[float], Field(min_length=7, max_length=7)]
TierName = Tier
ParameterValue = bool | int | float | str
#: Ids of two nodes.
Pair = Annotated[list[int], Field(min_length=2, max_length=2)]
#: Least and greatest.
Range = Annotated[list[float], Field(min_length=2, max_length=2)]
Axes = Annotated[list[float], Field(min_length=3, max_length=3)]


class Schema(BaseModel):
    """A shape that the page may see; ``from_`` in code is ``from`` in JSON."""

    model_config = ConfigDict(populate_by_name=True, extra="forbid", use_attribute_docstrings=True)


class ErrorDetail(Schema):
    """What was refused and what would be right."""

    code: str
    message: str
    status: int
    table: str | None = None
    """Of the row of the map file that can't be understood, where it is one."""
    row: str | None = None
    reason: str | None = None


class RowFault(Schema):
    """A row of a map file that can't be understood; all others are shown."""

    table: str
    row: str
    """Its id, or both ids of a link."""
    reason: str


class ErrorBody(Schema):
    """The one shape of all errors."""

    error: ErrorDetail


class Size(Schema):
    """Of an image, in pixels."""

    width: int
    height: int


RunState = Literal["idle", "starting", "running", "paused", "finished", "stopped", "failed"]
