"""Shapes of nodes."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import PoseList, Schema, TierName
from server.schemas.decisions import JournalEntry


class NodeRow(Schema):
    """A node in a table."""

    id: int
    map_id: int
    weight: int
    stamp: float
    label: str
    tier: TierName
    words: int
    """Key points that became words of the dictionary."""
    loops: int


class NodePage(Schema):
    """One page of the node table."""

    total: int
    nodes: list[NodeRow]


class CameraModel(Schema):
    """A rectified pinhole camera, in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float


class NodeLink(Schema):
    """A link as seen from one of its nodes."""

    from_: int = Field(alias="from")
    to: int
    type: str
    translation_m: float | None


class NodeDetail(NodeRow):
    """One node in full."""

    pose: PoseList | None
    odom: PoseList | None
    truth: PoseList | None
    """Ground truth, laid over the path of the map."""
    camera: CameraModel | None
    features: int
    links: list[NodeLink]
    statistics: dict[str, float]
    has_image: bool
    has_depth: bool
    decisions: list[JournalEntry]


class NodeFeatures(Schema):
    """Key points of a node; entry i of each list is the same one."""

    x: list[float]
    y: list[float]
    size: list[float]
    angle: list[float]
    word: list[int]
    """Positive for a word of the dictionary."""
    depth_m: list[float | None]
