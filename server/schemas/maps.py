"""Shapes of map files."""

from __future__ import annotations

from server.schemas.base import Schema


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


class MapInfo(MapFacts):
    """A map of the catalogue in detail."""

    id: str
    name: str
    loops: int
    live: bool
    """Whether an engine is mapping it now."""
    writable: bool
    has_truth: bool
    ate_m: float | None
    """Absolute trajectory error against ground truth, SE(3)-aligned over all frames."""


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
