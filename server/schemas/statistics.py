"""Shapes of statistics and of the belief over places."""

from __future__ import annotations

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
