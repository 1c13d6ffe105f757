"""What routes ask for: the services, and the map that an address names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from fastapi import Depends, Path, Query
from starlette.requests import HTTPConnection

from server.browse.map_view import MapView
from server.services import Services


def services_of(connection: HTTPConnection) -> Services:
    """The services of the app, for HTTP and WebSocket routes alike."""
    found: Services = connection.app.state.services
    return found


ServicesDep = Annotated[Services, Depends(services_of)]
MapId = Annotated[str, Path(alias="map", min_length=1, max_length=300, description="Id of a map, from GET /api/maps.")]
NodeId = Annotated[int, Path(ge=1, le=2**31 - 1)]


Viewer = Annotated[
    str, Query(pattern=r"^[A-Za-z0-9-]{0,40}$", description="A name for one window, whose 3D view is its own.")
]


def view_of(services: ServicesDep, map_id: MapId) -> Iterator[MapView]:
    """The map of the address; UnknownMapError when there is none, DatabaseError when it can't be read."""
    view = services.view(map_id)
    with view.asked.one():
        yield view


ViewDep = Annotated[MapView, Depends(view_of)]
