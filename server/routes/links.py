"""Links of a map."""

from __future__ import annotations

from fastapi import APIRouter

from server.browse.links import known_link, link_detail
from server.browse.matches import matches
from server.routes.access import NodeId, ViewDep
from server.schemas import KnownLink, LinkDetail, LinkMatches

router = APIRouter(prefix="/api/maps/{map}/links/{from_id}/{to_id}", tags=["links"])


@router.get("")
def get_link(view: ViewDep, from_id: NodeId, to_id: NodeId) -> LinkDetail:
    """A link or a loop that was looked at, with its evidence."""
    snapshot = view.snapshot()
    return link_detail(snapshot, from_id, to_id, view.trials.done(snapshot.params))


@router.get("/known")
def get_known_link(view: ViewDep, from_id: NodeId, to_id: NodeId) -> KnownLink:
    """The same, or that nothing is known of the pair."""
    snapshot = view.snapshot()
    return known_link(snapshot, from_id, to_id, view.trials.done(snapshot.params))


@router.get("/matches")
def get_link_matches(view: ViewDep, from_id: NodeId, to_id: NodeId) -> LinkMatches:
    """Matched key points of both images."""
    return matches(view, from_id, to_id)
