"""Shapes of statistics and of the belief over places."""

from __future__ import annotations

from typing import Literal

from server.schemas.base import Schema


class Statistics(Schema):
    """Columns over the map's updates."""

    ids: list[int]
    stamps: list[float]
    values: dict[str, list[float | None]]


class StatisticNames(Schema):
    """All names that the map has, sorted."""

    names: list[str]


class Hypothesis(Schema):
    """The best places of one update's belief."""

    ids: list[int]
    likelihood: list[float]
    posterior: list[float]
    virtual_place: float
    value: float
    """What ``Rtabmap/LoopThr`` was compared with."""


class TimelineEvent(Schema):
    """Something that happened in one update."""

    at: int
    """The node of the update."""
    kind: Literal["session", "loop", "refused", "lost", "transfer", "retrieval"]
    text: str
    pairs: list[list[int]]
    """The loops that it is about: newer and older node of each."""


class TimelineUpdates(Schema):
    """The updates of a map, oldest first, and what happened in them."""

    revision: int
    ids: list[int]
    """The node of each update."""
    stamps: list[float]
    memory: bool
    """Whether the file records which node was in which memory; else the colours are today's."""
    events: list[TimelineEvent]
