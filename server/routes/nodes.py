"""Nodes of a map and their data."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from server.browse import nodes
from server.browse.nodes import NodeOrder
from server.browse.pictures import coloured_depth, stored_image, stored_right
from server.routes.access import NodeId, ViewDep
from server.routes.pictures import ANY, PNG, picture
from server.schemas import NodeDetail, NodeFeatures, NodePage

router = APIRouter(prefix="/api/maps/{map}/nodes", tags=["nodes"])


@router.get("")
def list_nodes(
    view: ViewDep,
    offset: Annotated[int, Query(ge=0)] = 0,
    limit: Annotated[int, Query(ge=1, le=500)] = 100,
    order: NodeOrder = "id",
    dropped: Annotated[bool, Query(description="With merged and dropped nodes, which are no part of the map.")] = False,
    q: Annotated[str, Query(max_length=100, description="Text in id or label.")] = "",
) -> NodePage:
    """Some rows of the node table."""
    return nodes.page(view, offset=offset, limit=limit, order=order, query=q, dropped=dropped)


@router.get("/{node_id}")
def get_node(view: ViewDep, node_id: NodeId) -> NodeDetail:
    """One node in full."""
    return nodes.detail(view, node_id)


@router.get("/{node_id}/image", response_class=Response, responses=ANY)
def get_node_image(view: ViewDep, node_id: NodeId) -> Response:
    """The colour image as it is stored."""
    return picture(*stored_image(view, node_id))


@router.get("/{node_id}/depth.png", response_class=Response, responses=PNG)
def get_node_depth(
    view: ViewDep,
    node_id: NodeId,
    max_m: Annotated[float, Query(alias="max", ge=0, le=1000, description="Depth of the last colour; 0 fits.")] = 0.0,
) -> Response:
    """The depth image in colours, transparent where unknown."""
    return picture(coloured_depth(view, node_id, max_m), "image/png")


@router.get("/{node_id}/right", response_class=Response, responses=ANY)
def get_node_right(view: ViewDep, node_id: NodeId) -> Response:
    """The right image of a stereo pair as it is stored."""
    return picture(*stored_right(view, node_id))


@router.get("/{node_id}/features")
def get_node_features(view: ViewDep, node_id: NodeId) -> NodeFeatures:
    """Key points with words and depth."""
    return nodes.features(view, node_id)
