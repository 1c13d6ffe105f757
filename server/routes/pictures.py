"""Responses that are images."""

from __future__ import annotations

import hashlib
from typing import Any

from fastapi import Response

#: What a route declares when its answer is an image.
JPEG: dict[int | str, dict[str, Any]] = {200: {"content": {"image/jpeg": {}}, "description": "An image."}}
PNG: dict[int | str, dict[str, Any]] = {200: {"content": {"image/png": {}}, "description": "An image."}}
ANY: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/jpeg": {}, "image/png": {}}, "description": "The image as it is stored."}
}

POINTS: dict[int | str, dict[str, Any]] = {
    200: {
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
        "description": "Points, 16 bytes each.",
    }
}


def picture(data: bytes, media_type: str) -> Response:
    """An image that the browser may keep for a minute: nodes don't change, but names of maps are used again."""
    tag = hashlib.sha256(data).hexdigest()[:16]
    headers = {"Cache-Control": "private, max-age=60", "ETag": f'"{tag}"'}
    return Response(data, media_type=media_type, headers=headers)
