"""Files made from a map."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Response

from server.browse.exports import PoseFormat, pose_file
from server.routes.access import ViewDep

router = APIRouter(prefix="/api/maps/{map}/export", tags=["export"])
_TEXT: dict[int | str, dict[str, Any]] = {200: {"content": {"text/plain": {}}, "description": "A text file."}}


@router.get("/poses", response_class=Response, responses=_TEXT)
def export_poses(view: ViewDep, format: PoseFormat = "tum") -> Response:
    """The trajectory (TUM, KITTI) or the graph (g2o)."""
    name, text = pose_file(view.reader, view.file.id, format)
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(text, media_type="text/plain; charset=utf-8", headers=headers)
