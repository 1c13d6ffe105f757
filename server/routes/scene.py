"""The 3D view of a map."""

from __future__ import annotations

from fastapi import APIRouter

from server.routes.access import ServicesDep, ViewDep
from server.schemas import Scene, SceneChange

router = APIRouter(prefix="/api/scene/{map}", tags=["scene"])


@router.get("")
def get_scene(services: ServicesDep, view: ViewDep) -> Scene:
    """Layers, colours and selection."""
    return services.scenes.get(view).state()


@router.patch("")
def change_scene(services: ServicesDep, view: ViewDep, change: SceneChange) -> Scene:
    """Change some of them, for everybody who looks at this map."""
    return services.scenes.get(view).change(change)


@router.post("/look")
def look_at_selected(services: ServicesDep, view: ViewDep) -> Scene:
    """Bring the cameras of everybody who looks at this map to the selected node."""
    scene = services.scenes.get(view)
    scene.look_at_selected()
    return scene.state()
