"""Map files."""

from __future__ import annotations

from fastapi import APIRouter, Response

from server.browse.landmarks import landmarks
from server.browse.pictures import preview
from server.browse.summary import detail, summary
from server.routes.access import ServicesDep, ViewDep
from server.routes.pictures import JPEG, picture
from server.schemas import Landmarks, MapInfo, Maps

router = APIRouter(prefix="/api/maps", tags=["maps"])


@router.get("")
def list_maps(services: ServicesDep) -> Maps:
    """All maps under the served folders."""
    live = services.session.live_map
    return Maps(maps=[summary(file, live=file.id == live) for file in services.catalog.files()])


@router.get("/{map}")
def get_map(services: ServicesDep, view: ViewDep) -> MapInfo:
    """One map in detail."""
    return detail(view, live=services.session.live_map == view.file.id, writable=services.deciding.is_writable(view))


@router.get("/{map}/landmarks")
def list_landmarks(view: ViewDep) -> Landmarks:
    """Tags and markers that were seen."""
    return Landmarks(landmarks=landmarks(view))


@router.get("/{map}/preview.jpg", response_class=Response, responses=JPEG)
def get_preview(view: ViewDep) -> Response:
    """The first image, small."""
    return picture(preview(view), "image/jpeg")
