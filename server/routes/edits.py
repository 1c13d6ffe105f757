"""Edits of links and nodes, and jobs."""

from __future__ import annotations

from fastapi import APIRouter

from server.browse.edits import prior_state
from server.routes.access import NodeId, ServicesDep, ViewDep
from server.schemas import (
    Covariances,
    DecisionResult,
    Job,
    JobStatus,
    LinkEdit,
    LinkEditResult,
    NodeDrop,
    NodeLabel,
    NodeLabels,
    NodePrior,
    NodePriorState,
    StartJob,
)

router = APIRouter(prefix="/api/maps/{map}", tags=["edits"])


@router.post("/links")
async def edit_link(services: ServicesDep, view: ViewDep, edit: LinkEdit) -> LinkEditResult:
    """Add, refine, edit or reset a link, or only see what that would do."""
    return await services.deciding.edit_link(view, edit)


@router.post("/nodes/drop")
async def drop_nodes(services: ServicesDep, view: ViewDep, drop: NodeDrop) -> DecisionResult:
    """Take nodes out of the map; odometry's way is bridged over them, and undo brings them back."""
    return await services.deciding.drop_nodes(view, drop)


@router.post("/nodes/label")
async def label_nodes(services: ServicesDep, view: ViewDep, labels: NodeLabels) -> DecisionResult:
    """Give several nodes a numbered label, or take theirs away."""
    return await services.deciding.label_nodes(view, labels)


@router.post("/links/covariances")
async def edit_covariances(services: ServicesDep, view: ViewDep, edit: Covariances) -> DecisionResult:
    """Give many links other covariances; their transforms stay."""
    return await services.deciding.edit_covariances(view, edit)


@router.get("/nodes/{node_id}/prior")
def get_prior(services: ServicesDep, view: ViewDep, node_id: NodeId) -> NodePriorState:
    """The prior of a node, and whether priors count."""
    return prior_state(view.snapshot(), node_id, ignored=services.deciding.ignores_priors(view))


@router.post("/nodes/{node_id}/prior")
async def edit_prior(services: ServicesDep, view: ViewDep, node_id: NodeId, prior: NodePrior) -> DecisionResult:
    """Give a node a prior, change it, or take it away."""
    return await services.deciding.edit_prior(view, node_id, prior)


@router.post("/nodes/{node_id}/label")
async def label_node(services: ServicesDep, view: ViewDep, node_id: NodeId, label: NodeLabel) -> DecisionResult:
    """Give a node a label, or take it away."""
    return await services.deciding.label_node(view, node_id, label)


@router.get("/job")
async def get_job(services: ServicesDep, view: ViewDep) -> JobStatus:
    """The last job of this map."""
    return JobStatus(job=services.jobs.of(view.file.id))


@router.post("/job")
async def start_job(services: ServicesDep, view: ViewDep, job: StartJob) -> Job:
    """Look for more loops, or refine links; what is found is one batch, which one undo takes back."""
    return await services.deciding.start_job(view, job)


@router.post("/job/cancel")
async def cancel_job(services: ServicesDep, view: ViewDep) -> JobStatus:
    """Stop the job; the map stays as it was before it began."""
    return await services.deciding.cancel_job(view)
