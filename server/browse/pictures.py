"""Images of nodes, as stored or made for looking at."""

from __future__ import annotations

from types import MappingProxyType
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from server.browse.map_view import MapView
from server.browse.nodes import require_known
from server.errors import NotFoundError
from slam.database.images import decode_color
from slam.errors import DatabaseError
from slam.maps.depth_edges import without_edges
from slam.maps.views import disparity_px, node_views

_PREVIEW_WIDTH, _PREVIEW_HEIGHT = 320, 1280
_PNG = b"\x89PNG"
DepthColours = Literal["turbo", "viridis", "jet", "gray"]
_MAPS = MappingProxyType({"turbo": cv2.COLORMAP_TURBO, "viridis": cv2.COLORMAP_VIRIDIS, "jet": cv2.COLORMAP_JET})
_LEAST_SPAN_M = 0.01


def stored_image(view: MapView, node_id: int) -> tuple[bytes, str]:
    """Colour image of a node as stored, and its media type; raises NotFoundError when it has none."""
    return _with_type(_present(view, node_id, "image"))


def stored_right(view: MapView, node_id: int) -> tuple[bytes, str]:
    """Right image of a stereo pair as stored, and its media type; raises NotFoundError when the node has none."""
    data = _present(view, node_id, "depth")
    if not view.reader.baselines(node_id):
        raise NotFoundError(f"node {node_id} of {view.file.name} has a depth image, and no right one")
    return _with_type(data)


def preview(view: MapView) -> bytes:
    """A small JPEG of the map's first image; raises NotFoundError when no node has one."""
    first = view.reader.first_node_with("image")
    stored = view.reader.preview() if first is None else None
    if first is None and stored is None:
        raise NotFoundError(f"{view.file.name} has no image")
    image = view.reader.image_bgr(first) if first is not None else decode_color(stored or b"")
    height = max(1, min(_PREVIEW_HEIGHT, round(image.shape[0] * _PREVIEW_WIDTH / image.shape[1])))
    small = cv2.resize(image, (_PREVIEW_WIDTH, height), interpolation=cv2.INTER_AREA)
    return bytes(cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 82])[1])


def coloured_depth(
    view: MapView, node_id: int, min_m: float, max_m: float, colours: DepthColours = "turbo", *, edges: bool = True
) -> bytes:
    """Depth as a PNG from ``min_m`` (blue, black) to ``max_m`` metres (red, white), transparent where unknown.

    With 0 as ``max_m`` nearly all depths are below it; what is nearer or farther has the first or last colour. Of a
    stereo pair depth is worked out. Without ``edges`` pixels between two surfaces are unknown.
    """
    _present(view, node_id, "depth")
    if _baselines(view, node_id):
        depth_m = np.hstack([seen.depth_m for seen in node_views(view.reader, node_id)])
    else:
        depth_m = view.reader.depth_m(node_id)
    depth_m = depth_m if edges else without_edges(depth_m)
    last = max_m if max_m > min_m else max(_far(depth_m), min_m + _LEAST_SPAN_M)
    return _coloured(depth_m, min_m, last, colours)


def coloured_disparity(view: MapView, node_id: int, colours: DepthColours = "turbo") -> bytes:
    """How many pixels farther left the right camera sees each pixel of the left one, as a PNG from 0 to nearly all.

    Raises:
        NotFoundError: the node has no stereo pair.
    """
    _present(view, node_id, "depth")
    baselines = _baselines(view, node_id)
    if not baselines:
        raise NotFoundError(f"node {node_id} of {view.file.name} has no stereo pair, and no disparity")
    seen = node_views(view.reader, node_id)
    disparity = np.hstack([disparity_px(one, baseline) for one, baseline in zip(seen, baselines, strict=True)])
    return _coloured(disparity, 0.0, _far(disparity), colours)


def coloured_confidence(view: MapView, node_id: int, colours: DepthColours = "turbo") -> bytes:
    """How sure the camera was of each pixel of depth, as a PNG from 0 to 100, transparent where it was not at all.

    Raises:
        NotFoundError: that is not stored of the node.
    """
    require_known(view.snapshot(), node_id)
    percent = view.reader.confidence(node_id)
    if percent is None:
        raise NotFoundError(f"node {node_id} of {view.file.name} has no confidence of its depth")
    return _coloured(percent.astype(np.float32), 0.0, 100.0, colours)


def _coloured(values: NDArray[np.float32], first: float, last: float, colours: DepthColours) -> bytes:
    share = np.clip((values - first) / (last - first), 0.0, 1.0)
    level = (np.nan_to_num(share) * 255).astype(np.uint8)
    image = cv2.applyColorMap(level, _MAPS[colours]) if colours != "gray" else cv2.cvtColor(level, cv2.COLOR_GRAY2BGR)
    known = ((values > 0) & np.isfinite(values)).astype(np.uint8) * 255
    return bytes(cv2.imencode(".png", np.dstack([image, known]), [cv2.IMWRITE_PNG_COMPRESSION, 3])[1])


def _baselines(view: MapView, node_id: int) -> tuple[float, ...]:
    """Of its stereo pairs; none where depth is stored, also beside a calibration that makes no sense."""
    try:
        return view.reader.baselines(node_id)
    except DatabaseError:
        # The node itself says so; its depth needs none.
        return ()


def _with_type(data: bytes) -> tuple[bytes, str]:
    return data, "image/png" if data.startswith(_PNG) else "image/jpeg"


def _far(values: NDArray[np.float32]) -> float:
    """A depth, or a disparity, that nearly all pixels are below."""
    known = values[(values > 0) & np.isfinite(values)]
    return float(np.percentile(known, 98)) if len(known) else 1.0


def _present(view: MapView, node_id: int, kind: str) -> bytes:
    if node_id not in view.snapshot().all_nodes.ids:
        raise NotFoundError(f"{view.file.name} has no node {node_id}")
    node = view.reader.node(node_id)
    if not (node.image_bytes if kind == "image" else node.depth_bytes):
        raise NotFoundError(f"node {node_id} of {view.file.name} has no {kind}")
    return view.reader.image_file(node_id) if kind == "image" else view.reader.depth(node_id)
