"""Trajectories and graphs as text files that other tools read: TUM, KITTI, plain matrices, TORO."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from slam.errors import DatabaseError
from slam.geometry import Pose, to_euler_rpy, to_quat_xyzw
from slam.graph.g2o import write_g2o
from slam.graph.graph import PoseGraph, ascending
from slam.saving import save

__all__ = ["write_g2o", "write_kitti", "write_raw", "write_toro", "write_tum"]

_UPPER = np.triu_indices(6)


def write_tum(
    path: Path,
    stamps: Sequence[float],
    T_map_base: Sequence[Pose],
    T_base_frame: Pose | None = None,
    ids: Sequence[int] | None = None,
) -> None:
    """Write lines ``stamp tx ty tz qx qy qz qw`` (https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats).

    Args:
        path: file to write.
        stamps: (N,) seconds.
        T_map_base: (N, 4, 4) poses.
        T_base_frame: (4, 4) pose in base of the frame whose path is wanted; ``camera.T_base_cam`` for the optical
            frame, which is what TUM's ground truth has; None for the base itself.
        ids: (N,) of the nodes, which become a ninth column as in RTAB-Map's format 11.

    Raises:
        DatabaseError: the file can't be written, or there aren't as many stamps as poses.
    """
    if len(stamps) != len(T_map_base):
        raise DatabaseError(f"{path}: {len(stamps)} stamps for {len(T_map_base)} poses; each pose needs its stamp")
    lines = ["# timestamp tx ty tz qx qy qz qw" if ids is None else "# timestamp tx ty tz qx qy qz qw id"]
    for stamp, T in zip(stamps, _in_frame(T_map_base, T_base_frame), strict=True):
        lines.append(f"{stamp:.6f} " + " ".join(f"{v:.9f}" for v in (*T[:3, 3], *to_quat_xyzw(T))))
    if ids is not None:
        lines[1:] = [f"{line} {node_id}" for line, node_id in zip(lines[1:], ids, strict=True)]
    save(path, "\n".join([*lines, ""]))


def write_kitti(path: Path, T_map_base: Sequence[Pose], T_base_frame: Pose | None = None) -> None:
    """Write one line of twelve numbers for each pose, the rows of its (3, 4) matrix (KITTI odometry benchmark).

    KITTI's own files have the optical frame: pass ``camera.T_base_cam`` as ``T_base_frame`` for that.

    Raises:
        DatabaseError: the file can't be written.
    """
    lines = [" ".join(f"{v:.9e}" for v in T[:3].ravel()) for T in _in_frame(T_map_base, T_base_frame)]
    save(path, "\n".join([*lines, ""]))


def write_raw(path: Path, T_map_base: Sequence[Pose], T_base_frame: Pose | None = None) -> None:
    """Write the twelve numbers of each pose, the rows of its (3, 4) matrix, in the map's own axes.

    Raises:
        DatabaseError: the file can't be written.
    """
    write_kitti(path, T_map_base, T_base_frame)


def write_toro(path: Path, graph: PoseGraph) -> None:
    """Write nodes and links between them as TORO's ``VERTEX3`` and ``EDGE3`` (roll, pitch, yaw in radians).

    The format: https://openslam-org.github.io/toro.html. Links are from the smaller id, information is its upper
    triangle by rows.

    Raises:
        DatabaseError: the file can't be written.
    """
    lines = [f"VERTEX3 {i} {_six(graph.poses[i])}" for i in sorted(graph.poses)]
    for pair in sorted(graph.links):
        link = ascending(graph.links[pair])
        if link.T_from_to is not None and graph.poses.keys() >= set(pair):
            information = " ".join(repr(float(v)) for v in link.information[_UPPER])
            lines.append(f"EDGE3 {link.from_id} {link.to_id} {_six(link.T_from_to)} {information}")
    save(path, "\n".join([*lines, ""]))


def _six(T: Pose) -> str:
    return " ".join(repr(float(v)) for v in (*T[:3, 3], *to_euler_rpy(T)))


def _in_frame(T_map_base: Sequence[Pose], T_base_frame: Pose | None) -> list[Pose]:
    T = np.eye(4) if T_base_frame is None else T_base_frame
    return [np.asarray(pose @ T) for pose in T_map_base]
