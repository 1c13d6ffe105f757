"""How a map's graph hangs together, and how else it could be optimised."""

from __future__ import annotations

from fastapi import APIRouter

from server.browse.node_values import node_values, value_names
from server.browse.pieces import component_list
from server.routes.access import ServicesDep, ViewDep
from server.schemas import (
    Components,
    DecisionResult,
    KeepPoses,
    NodeValues,
    OptimiseAsk,
    Optimised,
    TurnMap,
    ValueNames,
)

router = APIRouter(prefix="/api/maps/{map}", tags=["graph"])


@router.get("/components")
def list_components(view: ViewDep) -> Components:
    """What links join, and what was refused between it and the rest."""
    return component_list(view)


@router.post("/what-if/optimise")
def optimise_graph(view: ViewDep, ask: OptimiseAsk) -> Optimised:
    """Optimise the graph otherwise; nothing is stored."""
    return view.optimisations.course(view.snapshot(), ask).told


@router.post("/poses/optimise")
async def keep_poses(services: ServicesDep, view: ViewDep, body: KeepPoses) -> DecisionResult:
    """Make the poses of an optimisation those of the map, or only see what that would do."""
    return await services.deciding.keep_poses(view, body)


@router.post("/poses/turn")
async def turn_map(services: ServicesDep, view: ViewDep, body: TurnMap) -> DecisionResult:
    """Turn the whole map as it is, or lay it over truth or GPS, or only see what that would do."""
    return await services.deciding.turn_map(view, body)


@router.get("/node-values")
def list_value_names(view: ViewDep) -> ValueNames:
    """What nodes can be coloured by."""
    return value_names(view)


@router.get("/node-values/{name:path}")
def get_node_values(view: ViewDep, name: str) -> NodeValues:
    """One of them: its range, and the value of each node."""
    return node_values(view, name)
