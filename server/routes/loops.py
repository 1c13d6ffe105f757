"""Loops of a map and people's decisions about them."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from server.browse.journal import journal_entry
from server.browse.loops import loops
from server.routes.access import ServicesDep, ViewDep
from server.schemas import Decision, DecisionResult, Journal, Loops, LoopWeights, LoopWhatIf

router = APIRouter(prefix="/api/maps/{map}", tags=["loops"])


@router.get("/loops")
def list_loops(
    view: ViewDep, after: Annotated[int, Query(ge=0, description="Only loops of updates after this node.")] = 0
) -> Loops:
    """Every loop that is in the graph, was refused, or was decided about."""
    return loops(view.snapshot(), after)


@router.get("/what-if/loops")
def foresee_loops(
    view: ViewDep,
    loop_thr: Annotated[float, Query(ge=0, le=1, description="Instead of the value in force.")],
    graph: Annotated[bool, Query(description="Optimise the graph with these loops as well.")] = False,
) -> LoopWhatIf:
    """The loops that would be there with another Rtabmap/LoopThr; nothing is changed."""
    return view.what_ifs.at(loop_thr, with_graph=graph)


@router.post("/loop-weights")
def weigh_loops(services: ServicesDep, view: ViewDep) -> LoopWeights:
    """Begin to work out how much GNC lets each loop count; the stream tells when it is done (``weights``)."""
    return services.robust.start(view)


@router.get("/loop-weights")
def get_loop_weights(services: ServicesDep, view: ViewDep) -> LoopWeights:
    """What GNC said last, or that it is at it."""
    return services.robust.state(view)


@router.get("/decisions")
def list_decisions(view: ViewDep) -> Journal:
    """All decisions, oldest first."""
    return Journal(entries=[journal_entry(entry) for entry in view.snapshot().journal])


@router.post("/decisions")
async def make_decision(services: ServicesDep, view: ViewDep, decision: Decision) -> DecisionResult:
    """Approve or reject one loop or several, undo or redo what was decided last; the graph is optimised anew."""
    return await services.deciding.decide(view, decision)
