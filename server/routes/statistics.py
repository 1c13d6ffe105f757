"""A map's updates, what happened in them and what they measured."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from server.browse.events import updates
from server.browse.statistics import hypothesis
from server.routes.access import NodeId, ViewDep
from server.schemas import Hypothesis, StatisticNames, Statistics, TimelineUpdates

router = APIRouter(prefix="/api/maps/{map}", tags=["statistics"])


@router.get("/statistics")
def get_statistics(
    view: ViewDep,
    names: Annotated[str, Query(max_length=4000, description="RTAB-Map's names, separated by commas.")],
    after: Annotated[int, Query(ge=0, description="Only updates after this node.")] = 0,
) -> Statistics:
    """Columns over the updates."""
    return view.statistics.columns([name for name in names.split(",") if name], after)


@router.get("/statistic-names")
def list_statistic_names(view: ViewDep) -> StatisticNames:
    """Names of all statistics that the map has."""
    return StatisticNames(names=view.statistics.names())


@router.get("/hypothesis/{node_id}")
def get_hypothesis(view: ViewDep, node_id: NodeId) -> Hypothesis:
    """The belief over places after the update of a node."""
    return hypothesis(view.reader, node_id)


@router.get("/timeline")
def get_timeline(view: ViewDep) -> TimelineUpdates:
    """All updates with what happened in them."""
    return updates(view.timeline())
