"""What the reader hands out of the records that slamdeck alone keeps: updates, candidates, parameter changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from slam.geometry import Pose
from slam.types import Candidate, Tier


@dataclass(frozen=True, slots=True, eq=False)
class UpdateRow:
    """One map update, as slamdeck recorded it.

    Attributes:
        id: the node it added.
        frame_index: of the source.
        stamp: seconds.
        weight: weight the node ended up with.
        T_map_base: pose in the map as it was then, None when lost.
        best_id: most probable place, 0 for none.
        value: what LoopThr was compared with; NaN where no belief was computed.
        virtual_place: probability of being nowhere known; NaN likewise.
        optimized: whether poses of older nodes moved.
        tiers: id -> tier of the nodes whose tier changed.
        matches: of the odometry.
        inliers: of the odometry.
        keyframe: whether odometry's local map took in the frame.
        odometry_ms: time of the odometry.
        time_ms: time of the update without odometry.
    """

    id: int
    frame_index: int
    stamp: float
    weight: int
    T_map_base: Pose | None
    best_id: int
    value: float
    virtual_place: float
    optimized: bool
    tiers: Mapping[int, Tier]
    matches: int
    inliers: int
    keyframe: bool
    odometry_ms: float
    time_ms: float


class LoopState(StrEnum):
    """Where a loop stands: what the engine did, or the last decision about it that stands."""

    ACCEPTED = "accepted"
    REFUSED = "refused"
    APPROVED = "approved"
    REJECTED = "rejected"
    ADDED = "added"


@dataclass(frozen=True, slots=True, eq=False)
class CandidateRow:
    """A loop closure that was looked at.

    Attributes:
        id: running number in the file.
        update_id: the node of the update that looked at it.
        candidate: the evidence.
        state: what became of it, decisions included.
    """

    id: int
    update_id: int
    candidate: Candidate
    state: LoopState


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """A parameter changed while the engine ran: from node ``node_id`` on, ``name`` has ``value`` (text)."""

    id: int
    time: float
    node_id: int
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class LostFrame:
    """A frame that odometry could not follow: the last node before it (0 before the first), its stamp, and why."""

    node_id: int
    stamp: float
    reason: str
