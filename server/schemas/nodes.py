"""Shapes of nodes."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import Axes, Pair, PoseList, Range, RowFault, Schema, TierName
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
    at: int | None
    """Row of the node that was to be found among all; None where it is not among them."""


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
    mount: PoseList | None = None
    """Of the optical frame (z forward) in the base frame."""


class NodeLink(Schema):
    """A link as seen from one of its nodes."""

    from_: int = Field(alias="from")
    to: int
    type: str
    translation_m: float | None
    transform: PoseList | None
    """From the node it starts at; of a prior in the map frame; of gravity its roll and pitch alone count."""
    sigma_m: float | None
    """Largest standard deviation of the three axes; None where nothing is known."""
    sigma_deg: float | None


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
    bytes: int
    text: str | None
    """Where it is text."""


class CloudFacts(Schema):
    """The stored scan of a node."""

    points: int
    normals: bool
    intensities: bool
    format: str
    """What is stored of each point."""
    range_m: float
    """Distance of the farthest point from the base."""
    scanner_range_m: Range | None
    """Least and greatest distance that the scanner measures, where the file says so."""
    angles_deg: Axes | None
    """First, last and step of a planar scanner, where the file says so."""
    most: int
    """Points of a whole sweep; 0 where the file does not say."""
    mount: PoseList | None
    """Of the scanner in the base frame."""
    reach_m: float
    """Half of the side of its picture."""


class GridFacts(Schema):
    """Cells of a node's local grid."""

    ground: int
    obstacles: int
    empty: int
    cell_size_m: float
    view_point: Axes
    """Where it was seen from, in the base frame."""
    reach_m: float
    """Half of the side of its picture."""


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
    session_index: int
    """Its place among the nodes of its session, from 1."""
    session_nodes: int
    image_bytes: int
    depth_bytes: int
    links: list[NodeLink]
    statistics: dict[str, float]
    has_image: bool
    has_depth: bool
    has_right: bool
    """Whether the right image of a stereo pair is stored, in place of depth."""
    has_confidence: bool
    """Whether it is stored how sure the camera was of its depth."""
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


class PixelDepth(Schema):
    """A pixel of a node's images."""

    u: float | None
    """Where the centre of the depth pixel is in the colour image, whole numbers at pixel centres; None without a
    calibration that fits."""
    v: float | None
    depth_u: int
    """Column of the pixel of the depth image."""
    depth_v: int
    depth_width: int
    depth_height: int
    depth_m: float | None
    """Along the optical axis; None where no depth was measured."""
    stereo: bool
    """Whether depth is worked out from a stereo pair, and not stored."""
    confidence: int | None
    """How sure the camera was of it, 0 to 100; None where that is not stored."""
    camera: int
    """Of several cameras, whose image it is in, from 0."""
    base: Axes | None
    """The point in the base frame, metres."""
    map: Axes | None
    """The same in the map frame."""


class PoseDifference(Schema):
    """The pose of one node as seen from another."""

    transform: PoseList
    translation_m: float
    rotation_deg: float


class SharedWords(Schema):
    """Key points of two nodes that are the same words."""

    words: int
    """Different words that both have."""
    of: Pair
    """Different words of each."""
    shared_a: list[int]
    """Key points of the first node whose word the second has too."""
    shared_b: list[int]
    word: list[int]
    """Words that each has once; entry i of the next two lists is that key point."""
    a: list[int]
    b: list[int]


class NodePair(Schema):
    """Two nodes beside each other: the second as seen from the first."""

    apart_s: float
    map: PoseDifference | None
    """By the optimised poses."""
    odometry: PoseDifference | None
    """None between sessions, which have odometry of their own."""
    truth: PoseDifference | None
    links: list[NodeLink]
    words: SharedWords
