"""Shapes of an optimisation that is looked at, of keeping its poses, and of turning a map."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from server.schemas.base import Schema
from server.schemas.edits import Author


class OptimiseAsk(Schema):
    """How to optimise the graph."""

    root: Annotated[int, Field(ge=1)] | None = None
    """The node held fixed; null for the one that the parameters choose."""
    without: list[Annotated[str, Field(max_length=40)]] = Field(default_factory=list)
    """Types of links that do not count, ``GlobalClosure`` or ``Landmark`` say."""
    solver: Annotated[int, Field(ge=0, le=2)] | None = None
    """Instead of ``GTSAM/Optimizer``: Levenberg-Marquardt, Gauss-Newton, Dogleg."""
    kernel: Literal["none", "DCS", "Cauchy", "GNC"] | None = None
    """Instead of ``Optimizer/Robust`` and its kernel."""
    start: Literal["odometry", "map"] = "odometry"
    """Where it begins: poses put together along the links from the root, or those of the map."""
    align: bool = False
    """Lay the result over the true path."""


class GraphState(Schema):
    """A graph at some poses."""

    chi2: float
    ate_m: float | None
    path_m: float
    """Length of the path through the nodes, metres."""


class Optimised(Schema):
    """What came of it."""

    root: int
    nodes: int
    links: int
    """That counted, with priors, gravity and sightings."""
    dropped: int
    """Nodes that nothing joins with the root then."""
    now: GraphState
    """The same links at the poses of the map."""
    steps: list[GraphState]
    """The start and each iteration; those of GNC are start and end."""
    seconds: float
    max_shift_m: float
    """From the map's poses to the last step's."""
    outliers: list[list[int]]
    """Loops that the kernel took the weight from."""
    fallback: bool
    """Whether the solver asked for found no way and another one did."""


class ShownOptimisation(Schema):
    """An optimisation whose path is shown beside the map's."""

    ask: OptimiseAsk
    step: Annotated[int, Field(ge=0, le=10_000)]


class KeepPoses(Schema):
    """An optimisation whose poses are to be those of the map; links stay as they are."""

    ask: OptimiseAsk
    """How; ``align`` is for looking alone."""
    step: Annotated[int, Field(ge=0, le=10_000)] | None = None
    """The iteration whose poses are kept, 0 for the start; null for the last."""
    author: Author = ""
    preview: bool = False


class TurnMap(Schema):
    """Where the whole map is to be, as it is."""

    yaw_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    """Turned by this about the z axis of the map."""
    to: Literal["truth", "gps"] | None = None
    """Instead of that laid over the ground truth, or over GPS: x east, y north, from the first reading."""
    author: Author = ""
    preview: bool = False

    @model_validator(mode="after")
    def _is_one(self) -> TurnMap:
        if (self.to is None) == (self.yaw_deg == 0):
            raise ValueError("name one: yaw_deg, other than 0, or what to lay the map over")
        return self
