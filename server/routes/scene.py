"""The 3D view of a map."""

from __future__ import annotations

from fastapi import APIRouter

from server.routes.access import ServicesDep, ViewDep, Viewer
from server.schemas import Scene, SceneChange

router = APIRouter(prefix="/api/scene/{map}", tags=["scene"])


@router.get("")
def get_scene(services: ServicesDep, view: ViewDep, viewer: Viewer = "") -> Scene:
    """Layers, colours and selection."""
    return services.scenes.get(view, viewer).state()


@router.patch("")
def change_scene(services: ServicesDep, view: ViewDep, change: SceneChange, viewer: Viewer = "") -> Scene:
    """Change some of them, for one window, or for all that give no name."""
    return services.scenes.get(view, viewer).change(change)


@router.post("/look")
def look_at_selected(services: ServicesDep, view: ViewDep, viewer: Viewer = "") -> Scene:
    """Bring the camera of a window to the selected node."""
    scene = services.scenes.get(view, viewer)
    scene.look_at_selected()
    return scene.state()
