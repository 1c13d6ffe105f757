"""The application: its parts put together, and nothing started yet."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from fastapi import FastAPI
from fastapi.middleware.gzip import GZipMiddleware
from fastapi.routing import APIRoute

from server import proxy
from server.engine.commands import RunJob
from server.engine.events import Event
from server.engine.nursery import warm_up
from server.error_responses import ERRORS, install_handlers
from server.routes import (
    edits,
    events,
    exports,
    graph,
    links,
    loops,
    maps,
    nodes,
    parameters,
    scene,
    session,
    statistics,
    structure,
    trials,
)
from server.security.guard import Guard
from server.services import Services
from server.settings import Settings
from server.static import Page
from slam.errors import SlamError

#: Shorter answers are one packet either way.
_WORTH_PACKING = 1000
_ROUTES = (maps, graph, structure, edits, nodes, links, loops, statistics, parameters, trials, session, scene, exports)


@dataclass(frozen=True, slots=True)
class FirstRun:
    """A run that starts with the server.

    Attributes:
        map_id: under which the page will know its map.
        job: what to map, and where to.
        on_event: hears everything that the engine tells.
    """

    map_id: str
    job: RunJob
    on_event: Callable[[Event], None]


def create_app(settings: Settings, web: Path | None = None, first_run: FirstRun | None = None) -> FastAPI:
    """The ASGI application.

    Args:
        settings: how to serve, and what.
        web: folder of the page; None serves the API alone.
        first_run: to start as soon as the server runs.
    """
    app = FastAPI(
        title="slamdeck",
        version=_version(),
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=_operation_id,
    )
    app.state.services = Services(settings)
    app.state.first_run = first_run
    install_handlers(app)
    for module in _ROUTES:
        app.include_router(module.router, responses=ERRORS)
    app.include_router(events.router)
    app.include_router(proxy.router)
    if web is not None:
        app.mount("/", Page(directory=web, html=True), name="page")
    # Lists of nodes and loops become a fifth within milliseconds; images and the 3D view's file stay as they are.
    app.add_middleware(GZipMiddleware, minimum_size=_WORTH_PACKING, compresslevel=1)
    app.add_middleware(Guard, settings=settings, index=None if web is None else web / "index.html")
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    services.hub.attach(asyncio.get_running_loop())
    warm_up()
    first = asyncio.create_task(_start(services, app.state.first_run))
    try:
        yield
    finally:
        await services.close()
        await first
        services.hub.detach()


async def _start(services: Services, run: FirstRun | None) -> None:
    # What refuses it is told by the engine's last event, to the page and to ``on_event``.
    if run is not None:
        with suppress(SlamError):
            await services.session.start(run.map_id, run.job, run.on_event)


def _operation_id(route: APIRoute) -> str:
    return route.name


def _version() -> str:
    try:
        return version("slamdeck")
    except PackageNotFoundError:
        return "0"
