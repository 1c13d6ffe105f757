"""The whole map as one coloured cloud."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.maps.point_cloud import Colors, Points, assemble, node_cloud, write_ply
from slam.maps.views import node_views

#: Every so manieth pixel of depth images, in both directions, as RTAB-Map's tools take them.
_STEP = 4
#: Points of a scanner that stores no colours.
_GRAY = 170
VOXEL_M, RANGE_M = 0.02, 6.0


def export_cloud(
    reader: MapReader, path: Path, poses: Mapping[int, Pose], voxel_m: float = VOXEL_M, range_m: float = RANGE_M
) -> int:
    """Write what all nodes saw as binary PLY in the map frame, red, green and blue with each point.

    Points are of depth images, also those worked out of stereo pairs; of nodes without any, of their scans.

    Args:
        reader: the map.
        path: ends in .ply.
        poses: id -> ``T_map_base``; nodes without one are left out.
        voxel_m: side of the voxels that have one point each, metres.
        range_m: depth beyond this is left out, metres; 0 is no limit. Scans are whole.

    Returns:
        The number of points.

    Raises:
        DatabaseError: nothing is to be had, an image is damaged, or the file can't be written.
    """
    if voxel_m <= 0 or range_m < 0:
        raise DatabaseError(f"voxels of {voxel_m:g} m, range of {range_m:g} m: need more than 0, and 0 or more")
    points, colours = assemble(_clouds(reader, poses, range_m), voxel_m)
    if not len(points):
        raise DatabaseError(f"{reader.path}: no node with a pose has depth within {range_m:g} m, or a scan")
    write_ply(path, points, colours)
    return len(points)


def _clouds(reader: MapReader, poses: Mapping[int, Pose], range_m: float) -> Iterator[tuple[Pose, Points, Colors]]:
    kinds = [set(reader.nodes_with(kind).tolist()) for kind in ("image", "depth", "calibration")]
    pictured, scanned = set.intersection(*kinds), set(reader.nodes_with("scan").tolist())
    for node_id in sorted(poses.keys() & (pictured | scanned)):
        if node_id in pictured:
            for view in node_views(reader, node_id):
                yield poses[node_id], *node_cloud(view.image_bgr, view.depth_m, view.camera, _STEP, range_m)
        elif (stored := reader.stored_scan(node_id)) is not None:
            points = stored.scan.points_base
            colours = np.full(points.shape, _GRAY, np.uint8) if stored.colours is None else stored.colours
            yield poses[node_id], points, colours
