"""Parameters of a map."""

from __future__ import annotations

from fastapi import APIRouter

from server.browse.parameters import parameter_set
from server.routes.access import ServicesDep, ViewDep
from server.schemas import ParameterChanges, ParameterSet

router = APIRouter(prefix="/api/maps/{map}/parameters", tags=["parameters"])


@router.get("")
def get_parameters(services: ServicesDep, view: ViewDep) -> ParameterSet:
    """All parameters: as the engine has them while it runs, else as the file has them."""
    snapshot = view.snapshot()
    in_force = services.session.parameters_of(view.file.id)
    values = dict(snapshot.params.items()) if in_force is None else in_force
    return parameter_set(values, snapshot.parameter_texts, live=in_force is not None)


@router.patch("")
async def change_parameters(services: ServicesDep, view: ViewDep, changes: ParameterChanges) -> ParameterSet:
    """Change parameters of the engine that runs, or of a map that no engine makes; answers with all values then.

    A map's own parameters are what its next decision is optimised with, and what programs that open it begin with.
    """
    values = await services.set_parameters(view, changes.changes)
    live = services.session.parameters_of(view.file.id) is not None
    return parameter_set(values, view.snapshot().parameter_texts, live=live)
