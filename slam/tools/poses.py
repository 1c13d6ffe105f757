"""The poses of a map as text files, in the formats that RTAB-Map's tools write."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

import numpy as np

from slam.camera import T_BASE_OPTICAL
from slam.database import MapReader
from slam.errors import DatabaseError
from slam.export import write_kitti, write_raw, write_toro, write_tum
from slam.geometry import Pose, inverse, to_quat_xyzw
from slam.graph.g2o import write_g2o
from slam.graph.graph import PoseGraph
from slam.saving import save
from slam.tools.gps import write_kml
from slam.trajectory import assemble
from slam.types import WEIGHT_INVALID, LinkType

#: The world of TUM's motion capture as RTAB-Map has it, seen from a map whose x points forward.
_T_MAP_CAPTURE = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


class Format(StrEnum):
    """Text formats; RTAB-Map's number where it has one."""

    TUM = "tum"  # 10
    TUM_ID = "tum-id"  # 11
    RGBD_SLAM = "rgbd-slam"  # 1
    RAW = "raw"  # 0
    KITTI = "kitti"  # 2
    TORO = "toro"  # 3
    G2O = "g2o"  # 4
    KML = "kml"


class Which(StrEnum):
    """Poses of the optimised map, of odometry, or true ones."""

    OPTIMIZED = "optimized"
    ODOMETRY = "odometry"
    TRUTH = "truth"


class Whose(StrEnum):
    """Whose path: of the camera's optical frame, or of the base."""

    CAM = "cam"
    BASE = "base"


class Every(StrEnum):
    """A pose for each tracked frame, where frames are stored, or for each node."""

    FRAME = "frame"
    NODE = "node"


def export_poses(
    reader: MapReader,
    path: Path,
    format: Format,
    whose: Whose = Whose.CAM,
    which: Which = Which.OPTIMIZED,
    every: Every = Every.FRAME,
) -> int:
    """Write poses, or with ``toro`` and ``g2o`` nodes and links in the base frame.

    ``tum-id`` has a line for each node; ``kml`` lays the path of the nodes over the earth by their GPS readings.
    ``rgbd-slam`` is the base in the axes of TUM's motion capture, as RTAB-Map's format 1; ``kitti`` of the camera has
    the optical axes of the first frame's world, as KITTI's own files.

    Returns:
        The number of poses written.

    Raises:
        DatabaseError: the map has no such pose, or the file can't be written.
    """
    graph = PoseGraph.from_reader(reader)
    if format in (Format.TORO, Format.G2O):
        graph.poses = _nodes(reader, graph, which)
        _require(reader, len(graph.poses), which)
        (write_toro if format is Format.TORO else write_g2o)(path, graph)
        return len(graph.poses)
    by_node = every is Every.NODE or format in (Format.TUM_ID, Format.KML)
    ids, stamps, poses = _path(reader, graph, which, by_node=by_node)
    _require(reader, len(poses), which)
    T_base_frame = _camera_pose(reader) if whose is Whose.CAM else np.eye(4)
    if format is Format.KML:
        write_kml(reader, path, ids, poses)
        return len(poses)
    if format is Format.RGBD_SLAM:
        poses = [inverse(T_BASE_OPTICAL) @ inverse(_T_MAP_CAPTURE) @ T for T in poses]
        T_base_frame = T_BASE_OPTICAL
    elif format is Format.KITTI and whose is Whose.CAM:
        poses = [inverse(T_BASE_OPTICAL) @ T for T in poses]
    if format is Format.KITTI:
        write_kitti(path, poses, T_base_frame)
    elif format is Format.RAW:
        write_raw(path, poses, T_base_frame)
    else:
        write_tum(path, stamps, poses, T_base_frame, ids if format is Format.TUM_ID else None)
    return len(poses)


def export_landmarks(reader: MapReader, path: Path) -> int:
    """Write lines ``id x y z qx qy qz qw`` of landmarks in the map: as optimised, or where the first node saw them.

    Returns:
        The number of landmarks.

    Raises:
        DatabaseError: no node saw one, or the file can't be written.
    """
    graph = PoseGraph.from_reader(reader)
    found = {i: T for i, T in reader.poses().items() if i < 0}
    for from_id, to_id, _ in sorted(graph.constraints):
        link = graph.constraints[from_id, to_id, LinkType.LANDMARK] if to_id < 0 else None
        if link is not None and link.T_from_to is not None and to_id not in found:
            found[to_id] = np.asarray(graph.poses[from_id] @ link.T_from_to)
    if not found:
        raise DatabaseError(f"{reader.path}: no node saw a landmark, there is nothing to export")
    lines = ["# id tx ty tz qx qy qz qw"]
    for number, T in sorted(found.items(), reverse=True):
        lines.append(f"{-number} " + " ".join(f"{v:.9f}" for v in (*T[:3, 3], *to_quat_xyzw(T))))
    save(path, "\n".join([*lines, ""]))
    return len(found)


def _nodes(reader: MapReader, graph: PoseGraph, which: Which) -> dict[int, Pose]:
    """Node -> pose of the base."""
    if which is Which.OPTIMIZED:
        return graph.poses
    if which is Which.ODOMETRY:
        return graph.T_odom
    table = reader.nodes()
    known = np.isfinite(table.T_world).all(axis=(1, 2)) & (table.weights > WEIGHT_INVALID)
    return {int(table.ids[row]): table.T_world[row] for row in np.flatnonzero(known)}


def _path(
    reader: MapReader, graph: PoseGraph, which: Which, *, by_node: bool
) -> tuple[list[int], list[float], list[Pose]]:
    """Ids of the nodes that poses belong to, stamps, and poses of the base, in the order of time."""
    nodes = _nodes(reader, graph, which)
    path = assemble(reader.trajectory(), graph.poses if which is Which.TRUTH else nodes)
    if len(path.stamps) and not by_node:
        poses = path.T_world_base if which is Which.TRUTH else path.T_map_base
        rows = np.flatnonzero(np.isfinite(poses).all(axis=(1, 2)))
        return path.node_ids[rows].tolist(), path.stamps[rows].tolist(), list(poses[rows])
    table = reader.nodes()
    kept = [row for row, node_id in enumerate(table.ids.tolist()) if node_id in nodes]
    ids = table.ids[kept].tolist()
    return ids, table.stamps[kept].tolist(), [nodes[i] for i in ids]


def _camera_pose(reader: MapReader) -> Pose:
    """Where the camera is in the base; the same for all nodes of a map."""
    calibrated = reader.nodes_with("calibration")
    if not len(calibrated):
        return np.array(T_BASE_OPTICAL)
    return reader.camera(int(calibrated[0])).T_base_cam


def _require(reader: MapReader, count: int, which: Which) -> None:
    if not count:
        told = {Which.OPTIMIZED: "pose", Which.ODOMETRY: "odometry pose", Which.TRUTH: "true pose"}[which]
        raise DatabaseError(f"{reader.path}: no node has a {told}, there is nothing to export")
