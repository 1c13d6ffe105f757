"""``slamdeck export``: trajectories for other tools."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from slam.errors import DatabaseError

if TYPE_CHECKING:
    from slam.database import MapReader
    from slam.geometry import Pose


class Format(StrEnum):
    """Formats of trajectories."""

    TUM = "tum"
    KITTI = "kitti"
    G2O = "g2o"


class Body(StrEnum):
    """Whose path is written."""

    CAM = "cam"
    BASE = "base"


def export(
    db: Annotated[Path, typer.Argument(help="Map file (.db) of slamdeck or RTAB-Map.")],
    poses: Annotated[Path, typer.Option("--poses", help="File to write the optimised poses to.")],
    format: Annotated[Format, typer.Option("--format", help="g2o has the links too.")] = Format.TUM,
    body: Annotated[Body, typer.Option("--frame", help="Path of the optical frame, or of the base.")] = Body.CAM,
    all_frames: Annotated[bool, typer.Option("--all-frames", help="Every tracked frame, not only nodes.")] = False,
) -> None:
    """Write the poses of a map; the map file isn't changed."""
    from slam.database import MapReader
    from slam.export import write_g2o, write_kitti, write_tum
    from slam.graph.graph import PoseGraph

    reader = MapReader(db)
    if format is Format.G2O:
        graph = PoseGraph.from_reader(reader)
        write_g2o(poses, graph)
        print(f"{len(graph)} poses and {len(graph.links)} links in {poses}")
        return
    stamps, path = _all_frames(reader) if all_frames else _nodes(reader)
    if not path:
        raise DatabaseError(f"{db}: holds no {'tracked frames' if all_frames else 'poses'} to export")
    T_base_frame = _camera_pose(reader) if body is Body.CAM else None
    if format is Format.TUM:
        write_tum(poses, stamps, path, T_base_frame)
    else:
        write_kitti(poses, path, T_base_frame)
    print(f"{len(path)} poses in {poses}")


def _nodes(reader: MapReader) -> tuple[list[float], list[Pose]]:
    table, optimized = reader.nodes(), reader.poses()
    kept = [
        (stamp, optimized[i])
        for i, stamp in zip(table.ids.tolist(), table.stamps.tolist(), strict=True)
        if i in optimized
    ]
    return [stamp for stamp, _ in kept], [pose for _, pose in kept]


def _all_frames(reader: MapReader) -> tuple[list[float], list[Pose]]:
    from slam.trajectory import assemble

    path = assemble(reader.trajectory(), reader.poses())
    return path.stamps.tolist(), list(path.T_map_base)


def _camera_pose(reader: MapReader) -> Pose:
    calibrated = reader.nodes_with("calibration")
    if not len(calibrated):
        raise DatabaseError(f"{reader.path}: no node has a camera; export the base with --frame base")
    return reader.camera(int(calibrated[0])).T_base_cam
