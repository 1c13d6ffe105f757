"""What a node adds to the view: what its cameras saw, or the points of its scanner."""

from __future__ import annotations

import numpy as np

from server.scene.cloud_points import CloudPoints, spread_points, view_points
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.maps.views import node_views

#: Points of scanners have no colour.
_GRAY = 150


def node_points(reader: MapReader, node_id: int, T_map_base: Pose, most: int, *, images: bool) -> CloudPoints:
    """At most so many points of a node in its base frame; of its scan where it has no ``images`` with depth.

    Raises:
        SlamError: images or scan can't be read, or there is neither.
    """
    if not images:
        return _scan_points(reader, node_id, most)
    views = node_views(reader, node_id)
    parts = [view_points(v.image_bgr, v.depth_m, v.camera, T_map_base, most // len(views)) for v in views]
    if len(parts) == 1:
        return parts[0]
    return CloudPoints(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.colours for part in parts]),
        max(part.spacing for part in parts),
    )


def _scan_points(reader: MapReader, node_id: int, most: int) -> CloudPoints:
    scan = reader.scan(node_id)
    if scan is None:
        raise DatabaseError(f"node {node_id} has neither images nor a scan")
    kept, side = spread_points(scan.points_base, most)
    points = scan.points_base[kept]
    return CloudPoints(points, np.full(points.shape, _GRAY, np.uint8), side)
