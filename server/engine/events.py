"""What an engine's process tells the server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from slam.errors import SlamError
from slam.geometry import Pose
from slam.params import Value
from slam.types import Candidate, Tier

if TYPE_CHECKING:
    from slam.effect import Effect


@dataclass(frozen=True, slots=True)
class Started:
    """The map is open for writing.

    Attributes:
        source: name of the source, empty when there is none.
        frames: how many it has, None when that is not known.
        params: values in force.
    """

    source: str
    frames: int | None
    params: Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a run is; told a few times a second and whenever its state changes."""

    state: Literal["running", "paused"]
    frame: int
    nodes: int
    lost: int
    fps: float
    ate_m: float | None


@dataclass(frozen=True, slots=True, eq=False)
class NodeAdded:
    """A node is in the file.

    Attributes:
        node_id: its id.
        frame: number of its frame.
        stamp: seconds.
        statistics: RTAB-Map's names and values.
        candidates: loops that were looked at.
        tiers: id -> tier of the nodes that moved between memories.
        optimized: whether older poses moved.
    """

    node_id: int
    frame: int
    stamp: float
    statistics: Mapping[str, float]
    candidates: tuple[Candidate, ...]
    tiers: Mapping[int, Tier]
    optimized: bool


@dataclass(frozen=True, slots=True, eq=False)
class Moved:
    """Where the camera is now: T_map_base, None while it is lost."""

    T_map_base: Pose | None


@dataclass(frozen=True, slots=True)
class GraphChanged:
    """Poses or links of the file are others now."""


@dataclass(frozen=True, slots=True)
class GridChanged:
    """The floor plan of the file is another now, and nothing else."""


@dataclass(frozen=True, slots=True)
class InForce:
    """Parameters as the engine has them."""

    values: Mapping[str, Value]


@dataclass(frozen=True, slots=True, eq=False)
class JobTold:
    """How a job is.

    Attributes:
        number: which one.
        state: whether it is under way, or how it ended.
        share: of the work that is done, 0 to 1.
        lines: of its log, new since the last event.
        error: why it failed.
        effect: on the map, when it is done; None where there was nothing to change.
    """

    number: int
    state: Literal["running", "done", "cancelled", "failed"]
    share: float
    lines: tuple[str, ...] = ()
    error: SlamError | None = None
    effect: Effect | None = None


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer to a request: a value, or the error that refused it."""

    number: int
    value: Any = None
    error: SlamError | None = None


@dataclass(frozen=True, slots=True)
class Ended:
    """The last event: the map is one plain file again.

    Attributes:
        state: how it ended.
        error: why it failed.
        summary: of a run.
    """

    state: Literal["finished", "stopped", "failed"]
    error: SlamError | None = None
    summary: Mapping[str, Any] | None = None


Event = Started | Progress | NodeAdded | Moved | GraphChanged | GridChanged | InForce | JobTold | Answer | Ended
