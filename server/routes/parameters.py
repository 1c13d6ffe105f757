"""Parameters of a map."""

from __future__ import annotations

from fastapi import APIRouter

from server.routes.access import ServicesDep, ViewDep
from server.schemas import ParameterChanges, ParameterSet

router = APIRouter(prefix="/api/maps/{map}/parameters", tags=["parameters"])


@router.get("")
def get_parameters(services: ServicesDep, view: ViewDep) -> ParameterSet:
    """All parameters: as the engine has them while it runs, else as the file has them."""
    return services.parameters(view)


@router.patch("")
async def change_parameters(services: ServicesDep, view: ViewDep, changes: ParameterChanges) -> ParameterSet:
    """Change parameters of the engine that runs, else of the file for its next session; answers with all in force."""
    return await services.change_parameters(view, changes.changes)
