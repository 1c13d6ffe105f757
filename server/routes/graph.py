"""The graph of a map."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from server.browse.graph import graph
from server.routes.access import ViewDep
from server.schemas import Graph

router = APIRouter(prefix="/api/maps/{map}", tags=["graph"])


@router.get("/graph")
def get_graph(
    view: ViewDep, after: Annotated[int, Query(ge=0, description="The revision that the caller has; 0 for none.")] = 0
) -> Graph:
    """Nodes and links as columns; with ``after``, only those that changed since, where that can be told."""
    return graph(view, after)
