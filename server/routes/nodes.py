"""Nodes of a map and their data."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from server.browse import nodes
from server.browse.nodes import NodeOrder
from server.browse.pairs import node_pair
from server.browse.pictures import (
    DepthColours,
    coloured_confidence,
    coloured_depth,
    coloured_disparity,
    stored_image,
    stored_right,
)
from server.browse.plans import grid_picture, scan_picture, trial_grid
from server.browse.sensors import grid_facts
from server.routes.access import NodeId, ViewDep
from server.routes.pictures import ANY, PNG, picture
from server.schemas import GridFacts, NodeDetail, NodeFeatures, NodePage, NodePair, PixelDepth

router = APIRouter(prefix="/api/maps/{map}/nodes", tags=["nodes"])

GridChanges = Annotated[
    str, Query(max_length=2000, description="Made anew with these parameters of Grid/, a JSON object by name.")
]


@router.get("")
def list_nodes(
    view: ViewDep,
    offset: Annotated[int, Query(ge=0)] = 0,
    limit: Annotated[int, Query(ge=1, le=500)] = 100,
    order: NodeOrder = "id",
    dropped: Annotated[bool, Query(description="With merged and dropped nodes, which are no part of the map.")] = False,
    q: Annotated[str, Query(max_length=200, description="Words in id or label, or id: label: time: near.")] = "",
    find: Annotated[int | None, Query(ge=1, description="Node whose row is told.")] = None,
) -> NodePage:
    """Some rows of the node table."""
    return nodes.page(view, offset=offset, limit=limit, order=order, query=q, dropped=dropped, find=find)


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
    min_m: Annotated[float, Query(alias="min", ge=0, le=1000, description="Depth of the first colour.")] = 0.0,
    colours: DepthColours = "turbo",
    edges: Annotated[bool, Query(description="Pixels at the edges of things as well.")] = True,
) -> Response:
    """The depth image in colours, transparent where unknown."""
    return picture(coloured_depth(view, node_id, min_m, max_m, colours, edges=edges), "image/png")


@router.get("/{node_id}/disparity.png", response_class=Response, responses=PNG)
def get_node_disparity(view: ViewDep, node_id: NodeId, colours: DepthColours = "turbo") -> Response:
    """The disparity of a stereo pair in colours, likewise."""
    return picture(coloured_disparity(view, node_id, colours), "image/png")


@router.get("/{node_id}/confidence.png", response_class=Response, responses=PNG)
def get_node_confidence(view: ViewDep, node_id: NodeId, colours: DepthColours = "turbo") -> Response:
    """How sure the camera was of its depth, from 0 to 100, likewise."""
    return picture(coloured_confidence(view, node_id, colours), "image/png")


@router.get("/{node_id}/right", response_class=Response, responses=ANY)
def get_node_right(view: ViewDep, node_id: NodeId) -> Response:
    """The right image of a stereo pair as it is stored."""
    return picture(*stored_right(view, node_id))


@router.get("/{node_id}/pixel")
def get_node_pixel(
    view: ViewDep,
    node_id: NodeId,
    x: Annotated[float, Query(ge=0, le=1, description="Across the whole image, from its left edge.")],
    y: Annotated[float, Query(ge=0, le=1, description="Down, from its top edge.")],
) -> PixelDepth:
    """Depth and point at a place of the images."""
    return nodes.pixel(view, node_id, x, y)


@router.get("/{node_id}/scan.png", response_class=Response, responses=PNG)
def get_node_scan(view: ViewDep, node_id: NodeId) -> Response:
    """The scan from above: base in the middle, its x axis up."""
    return picture(scan_picture(view, node_id), "image/png")


@router.get("/{node_id}/grid.png", response_class=Response, responses=PNG)
def get_node_grid(view: ViewDep, node_id: NodeId, changes: GridChanges = "") -> Response:
    """The local grid from above, likewise."""
    return picture(grid_picture(view, node_id, changes), "image/png")


@router.get("/{node_id}/grid")
def get_trial_grid(view: ViewDep, node_id: NodeId, changes: GridChanges = "{}") -> GridFacts:
    """What the local grid would be with other parameters."""
    return grid_facts(trial_grid(view, node_id, changes))


@router.get("/{node_id}/pair/{other_id}")
def get_node_pair(view: ViewDep, node_id: NodeId, other_id: NodeId) -> NodePair:
    """What two nodes have in common."""
    return node_pair(view, node_id, other_id)


@router.get("/{node_id}/features")
def get_node_features(view: ViewDep, node_id: NodeId) -> NodeFeatures:
    """Key points with words and depth."""
    return nodes.features(view, node_id)
