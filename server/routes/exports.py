"""Files made from a map."""

from __future__ import annotations

from typing import Annotated, Any
from urllib.parse import quote

from fastapi import APIRouter, Query, Response
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from server.browse.exports import PoseFormat, WhichPoses, cloud_file, grid_archive, pose_file
from server.routes.access import ViewDep
from slam.tools.cloud import RANGE_M, VOXEL_M

#: How OpenAPI tells of a file.
_BYTES = {"type": "string", "format": "binary"}

router = APIRouter(prefix="/api/maps/{map}/export", tags=["export"])


def _declared(media_type: str, what: str) -> dict[int | str, dict[str, Any]]:
    return {200: {"content": {media_type: {"schema": _BYTES}}, "description": what}}


@router.get("/poses", response_class=Response, responses=_declared("text/plain", "A text file."))
def export_poses(view: ViewDep, format: PoseFormat = "tum", which: WhichPoses = "optimized") -> Response:
    """The trajectory, or the graph (TORO, g2o)."""
    name, text = pose_file(view.reader, view.file.id, format, which)
    return Response(text, media_type="text/plain; charset=utf-8", headers=_named(name))


@router.get("/grid.zip", response_class=Response, responses=_declared("application/zip", "PGM and YAML."))
def export_grid(view: ViewDep) -> Response:
    """The floor plan as map_server loads it."""
    return Response(grid_archive(view), media_type="application/zip", headers=_named(f"{view.file.id}.grid.zip"))


@router.get("/cloud.ply", response_class=Response, responses=_declared("application/octet-stream", "A PLY file."))
def export_cloud(
    view: ViewDep,
    voxel: Annotated[float, Query(ge=0.001, le=10, description="Metres between points.")] = VOXEL_M,
    range_m: Annotated[float, Query(alias="range", ge=0, le=1000, description="Farthest depth; 0 for all.")] = RANGE_M,
) -> Response:
    """The coloured cloud of the whole map, in the map frame."""
    path = cloud_file(view, voxel, range_m)
    kind = "application/octet-stream"
    return FileResponse(
        path, media_type=kind, headers=_named(f"{view.file.id}.ply"), background=BackgroundTask(path.unlink)
    )


def _named(name: str) -> dict[str, str]:
    """The name under which a browser saves the answer; headers have ASCII alone, the rest is spelled (RFC 6266)."""
    plain = name.encode("ascii", "replace").decode("ascii").replace('"', "-")
    return {"Content-Disposition": f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"}
