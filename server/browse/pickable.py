"""The points of one node that somebody picks from on the page."""

from __future__ import annotations

import numpy as np

from server.browse.map_view import MapView
from server.browse.nodes import require_node
from server.scene.colours import DARK
from server.scene.node_details import dense_points, scan_points
from server.schemas.scene import DepthUse

#: More of them are no easier to pick from.
_MOST = 60_000
_ROW = np.dtype([("point", "<f4", 3), ("colour", "u1", 3), ("unused", "u1")])


def pickable_points(view: MapView, node_id: int) -> bytes:
    """Rows of 16 bytes: x y z in the base frame, metres (float32), red green blue (uint8), and nothing.

    Of the depth images, without the edges that hang in the air, else of the scan.

    Raises:
        NotFoundError: the map has no such node.
        SlamError: it has neither, or they are damaged.
    """
    require_node(view.snapshot(), node_id)
    node = view.reader.node(node_id)
    if node.image_bytes and node.depth_bytes and node.calibration_bytes:
        found = dense_points(view.reader, node_id, DepthUse(edges=False))
    else:
        found = scan_points(view.reader, node_id, DARK)
    # The same each time, and all over the cloud.
    kept = np.sort(np.random.default_rng(0).permutation(len(found.points))[:_MOST])
    rows = np.zeros(len(kept), _ROW)
    rows["point"], rows["colour"] = found.points[kept], found.colours[kept]
    return rows.tobytes()
