"""The application: its parts put together, and nothing started yet."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from fastapi import FastAPI
from fastapi.routing import APIRoute

from server import proxy
from server.error_responses import ERRORS, install_handlers
from server.routes import events, exports, graph, links, loops, maps, nodes, parameters, scene, session, statistics
from server.security.guard import Guard
from server.services import Services
from server.settings import Settings
from server.static import Page

_ROUTES = (maps, graph, nodes, links, loops, statistics, parameters, session, scene, exports)


def create_app(settings: Settings, web: Path | None = None, services: Services | None = None) -> FastAPI:
    """The ASGI application.

    Args:
        settings: how to serve, and what.
        web: folder of the page; None serves the API alone.
        services: to share with the caller; None makes them.
    """
    app = FastAPI(
        title="slamdeck",
        version=_version(),
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=_operation_id,
    )
    app.state.services = services or Services(settings)
    install_handlers(app)
    for module in _ROUTES:
        app.include_router(module.router, responses=ERRORS)
    app.include_router(events.router)
    app.include_router(proxy.router)
    if web is not None:
        app.mount("/", Page(directory=web, html=True), name="page")
    app.add_middleware(Guard, settings=settings, index=None if web is None else web / "index.html")
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    services.hub.attach(asyncio.get_running_loop())
    try:
        yield
    finally:
        await services.close()
        services.hub.detach()


def _operation_id(route: APIRoute) -> str:
    return route.name


def _version() -> str:
    try:
        return version("slamdeck")
    except PackageNotFoundError:
        return "0"
