"""Shapes of map files."""

from __future__ import annotations

from server.schemas.base import PoseList, RowFault, Schema


class MapFacts(Schema):
    """What ``slamdeck info`` says of a file."""

    version: str
    """Of RTAB-Map's schema."""
    sessions: int
    nodes: int
    dropped: int
    """Merged and dropped nodes (weight -9) that are kept in the file, not counted in ``nodes``."""
    links: dict[str, int]
    """By type name, each pair once."""
    words: int
    features: int
    size_bytes: int
    bytes_by_kind: dict[str, int]
    """Empty where it was not asked for."""
    parameters: dict[str, str]
    """Those that differ from the defaults."""
    seeds: list[int]
    sources: list[str]
    clean: bool
    """Whether the last session was closed in order."""
    has_poses: bool
    first_stamp: float | None
    last_stamp: float | None


class SessionFacts(Schema):
    """A session of a map."""

    map_id: int
    nodes: int
    source: str
    clean: bool
    joined_with: list[int]
    """Sessions that links join with this one."""


class MapInfo(MapFacts):
    """A map of the catalogue in detail."""

    id: str
    name: str
    loops: int
    refused: int
    """Loops that were looked at and are no links, or no more."""
    live: bool
    """Whether an engine is mapping it now."""
    writable: bool
    has_truth: bool
    ate_m: float | None
    """Absolute trajectory error against ground truth, SE(3)-aligned over all frames."""
    notes: list[str]
    """What is missing in the file and what was made up for, in sentences."""
    memory: dict[str, int]
    """Nodes in each memory (stm, wm, ltm) now."""
    session_list: list[SessionFacts]
    has_scans: bool
    """Whether a node has points of a scanner."""
    span_s: float
    """Seconds from the first to the last node, sessions added up."""
    odometry_m: float
    """Length of odometry's path, sessions added up."""
    map_m: float | None
    """The same through the optimised poses; None where no node has one."""
    has_model: bool
    """Whether a mesh or cloud of the whole map is stored."""
    faults: list[RowFault]
    """The first hundred rows of the file that make no sense; everything else is shown."""
    fault_count: int


class Landmark(Schema):
    """A tag or marker that nodes saw."""

    id: int
    """Its number, positive; links to it have the negative one."""
    pose: PoseList | None
    """In the map frame; None where no pose of it is known."""
    length_m: float | None
    """Of the marker's side, where it is stored."""
    seen_from: list[int]
    """Ids of the nodes that saw it."""


class Landmarks(Schema):
    """All landmarks of a map."""

    landmarks: list[Landmark]


class MapSummary(Schema):
    """A map in the list."""

    id: str
    name: str
    size_bytes: int
    modified: float
    """Unix seconds."""
    version: str
    sessions: int
    nodes: int
    links: dict[str, int]
    loops: int
    live: bool
    error: str | None = None
    """Why the file can't be opened."""


class Maps(Schema):
    """All maps under the served folders."""

    maps: list[MapSummary]
