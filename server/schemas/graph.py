"""Shapes of the graph as columns."""

from __future__ import annotations

from pydantic import Field

from server.schemas.base import PoseList, Schema, TierName


class NodeColumns(Schema):
    """Nodes; entry i of each list is the same node."""

    id: list[int]
    map_id: list[int]
    weight: list[int]
    stamp: list[float]
    tier: list[TierName]
    pose: list[PoseList | None]
    """Optimised, in the map frame."""
    odom: list[PoseList | None]
    truth: list[PoseList | None] | None
    """None when no node has one."""


class LinkColumns(Schema):
    """Links; entry i of each list is the same link."""

    from_: list[int] = Field(alias="from")
    to: list[int]
    type: list[str]
    residual_sigma: list[float | None]


class Graph(Schema):
    """The graph, or what came to it since a revision."""

    revision: int
    full: bool
    """False when these are only the nodes and links that came since the revision asked for."""
    nodes: NodeColumns
    links: LinkColumns
    correction: PoseList | None
    """``T_map_odom`` of the newest node."""
    ate_m: float | None


class ValueNames(Schema):
    """What nodes can be coloured by beside memory, session, time and weight."""

    names: list[str]
    """``loops``, ``residual``, ``altitude``, ``sensor:NAME``, ``stat:NAME``."""


class NodeValues(Schema):
    """One number for each node, as a scale of colours."""

    name: str
    unit: str
    low: float
    high: float
    """The 2nd and the 98th percentile: the ends of the scale."""
    known: int
    """Nodes that have one; the others are grey."""
