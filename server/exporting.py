"""Trajectories and graphs as files for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from slam.camera import T_BASE_OPTICAL
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.export import write_g2o, write_kitti, write_tum
from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.trajectory import assemble

PoseFormat = Literal["tum", "kitti", "g2o"]
PoseFrame = Literal["cam", "base"]


def export_poses(reader: MapReader, path: Path, format: PoseFormat, frame: PoseFrame = "cam") -> int:
    """Write the path of all tracked frames (of the nodes, where frames aren't stored), or the graph as g2o.

    Args:
        reader: of the map.
        path: file to write.
        format: ``tum``, ``kitti`` or ``g2o``; the last holds nodes and links in the base frame.
        frame: whose path: of the camera's optical frame, as the ground truth of TUM and KITTI, or of the base.

    Returns:
        The number of poses written.

    Raises:
        DatabaseError: the map has no pose, or the file can't be written.
    """
    graph = PoseGraph.from_reader(reader)
    if format == "g2o":
        _require(reader, len(graph.poses))
        write_g2o(path, graph)
        return len(graph.poses)
    stamps, poses = _path(reader, graph)
    _require(reader, len(poses))
    T_base_frame = _camera_pose(reader) if frame == "cam" else None
    if format == "tum":
        write_tum(path, stamps, poses, T_base_frame)
    else:
        write_kitti(path, poses, T_base_frame)
    return len(poses)


def _path(reader: MapReader, graph: PoseGraph) -> tuple[list[float], list[Pose]]:
    path = assemble(reader.trajectory(), graph.poses)
    if len(path.stamps):
        return path.stamps.tolist(), list(path.T_map_base)
    table = reader.nodes()
    rows = [row for row, node_id in enumerate(table.ids.tolist()) if node_id in graph.poses]
    return table.stamps[rows].tolist(), [graph.poses[int(table.ids[row])] for row in rows]


def _camera_pose(reader: MapReader) -> Pose:
    """Where the camera is in the base; the same for all nodes of a map."""
    calibrated = reader.nodes_with("calibration")
    if not len(calibrated):
        return np.array(T_BASE_OPTICAL)
    return reader.camera(int(calibrated[0])).T_base_cam


def _require(reader: MapReader, count: int) -> None:
    if not count:
        raise DatabaseError(f"{reader.path}: no node has a pose, there is nothing to export")
