"""The run."""

from __future__ import annotations

from fastapi import APIRouter

from server.routes.access import ServicesDep
from server.schemas import Session, SessionCommand, StartRun

router = APIRouter(prefix="/api/session", tags=["session"])


@router.get("")
async def get_session(services: ServicesDep) -> Session:
    """What the engine does."""
    return services.session.state


@router.post("")
async def start_session(services: ServicesDep, run: StartRun) -> Session:
    """Start mapping a source into a new map."""
    return await services.start_run(run)


@router.post("/{command}")
async def command_session(services: ServicesDep, command: SessionCommand) -> Session:
    """Pause, go on, take one step, or stop and close the map."""
    return await services.session.command(command)
