"""Shapes of nodes."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import PoseList, RowFault, Schema, TierName
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

    baseline_m: float | None = None
    """Of a stereo pair, whose left camera this is."""

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


class GpsFix(Schema):
    """A position on the earth; degrees, metres, seconds."""

    stamp: float
    longitude: float
    latitude: float
    altitude: float
    error: float
    bearing: float
    """Clockwise from north."""


class SensorReading(Schema):
    """What an environmental sensor measured."""

    name: str
    unit: str
    value: float
    stamp: float


class Vector(Schema):
    """A descriptor of the whole image."""

    type: int
    size: int


class UserData(Schema):
    """What a program attached to a node."""

    rows: int
    columns: int
    type: str
    text: str | None
    """Where it is text."""


class CloudFacts(Schema):
    """The stored scan of a node."""

    points: int
    normals: bool
    range_m: float
    """Distance of the farthest point from the base."""


class GridFacts(Schema):
    """Cells of a node's local grid."""

    ground: int
    obstacles: int
    empty: int
    cell_size_m: float


class NodeSensors(Schema):
    """What a node has besides images."""

    velocity: list[float] | None
    """x y z in metres a second, roll pitch yaw in radians a second."""
    gps: GpsFix | None
    readings: list[SensorReading]
    vectors: list[Vector]
    user_data: UserData | None
    scan: CloudFacts | None
    grid: GridFacts | None
    problems: list[str]
    """What is stored and can't be read, with the reason."""


class NodeDetail(NodeRow):
    """One node in full."""

    pose: PoseList | None
    odom: PoseList | None
    truth: PoseList | None
    """Ground truth, laid over the path of the map."""
    camera: CameraModel | None
    cameras: list[CameraModel]
    """All cameras, in the order of the tiles of the image; the first is ``camera``."""
    sensors: NodeSensors
    features: int
    links: list[NodeLink]
    statistics: dict[str, float]
    has_image: bool
    has_depth: bool
    has_right: bool
    """Whether the right image of a stereo pair is stored, in place of depth."""
    decisions: list[JournalEntry]
    faults: list[RowFault]
    """What of this node makes no sense; the rest is here."""


class NodeFeatures(Schema):
    """Key points of a node; entry i of each list is the same one."""

    x: list[float]
    y: list[float]
    size: list[float]
    angle: list[float]
    word: list[int]
    """Positive for a word of the dictionary."""
    depth_m: list[float | None]
