"""``slamdeck export``: poses, images and thinned copies for other tools."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from server.cli.options import ForceOption
from slam.errors import DatabaseError

if TYPE_CHECKING:
    from slam.database import MapReader


class Format(StrEnum):
    """Text formats of trajectories and graphs."""

    TUM = "tum"
    TUM_ID = "tum-id"
    RGBD_SLAM = "rgbd-slam"
    RAW = "raw"
    KITTI = "kitti"
    TORO = "toro"
    G2O = "g2o"
    KML = "kml"


class Whose(StrEnum):
    """Whose path is written."""

    CAM = "cam"
    BASE = "base"


class Which(StrEnum):
    """Which poses are written."""

    OPTIMIZED = "optimized"
    ODOMETRY = "odometry"
    TRUTH = "truth"


class Every(StrEnum):
    """What has a pose."""

    FRAME = "frame"
    NODE = "node"


def export(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file.")],
    poses: Annotated[Path | None, typer.Option(metavar="OUT", help="Text file of poses to write.")] = None,
    format: Annotated[
        Format,
        typer.Option(
            help="tum-id has ids, rgbd-slam the axes of motion capture; toro and g2o are graphs, kml is on the earth."
        ),
    ] = Format.TUM,
    frame: Annotated[Whose, typer.Option(help="Path of the camera's optical frame, or of the base.")] = Whose.CAM,
    which: Annotated[Which, typer.Option(help="Optimised poses, odometry, or ground truth.")] = Which.OPTIMIZED,
    every: Annotated[Every, typer.Option(help="A pose for every tracked frame, or for every node.")] = Every.FRAME,
    gps: Annotated[Path | None, typer.Option(metavar="OUT", help="GPS readings, as text or .kml.")] = None,
    landmarks: Annotated[Path | None, typer.Option(metavar="OUT", help="Text file of landmarks' poses.")] = None,
    images: Annotated[
        Path | None, typer.Option(metavar="DIR", help="New folder of images with calibration, as `run` reads it.")
    ] = None,
    grid: Annotated[Path | None, typer.Option(metavar="OUT.pgm", help="Floor plan, with YAML for map_server.")] = None,
    cloud: Annotated[Path | None, typer.Option(metavar="OUT.ply", help="Coloured cloud of the whole map.")] = None,
    voxel: Annotated[float, typer.Option(help="--cloud: metres between points.")] = 0.02,
    range_m: Annotated[float, typer.Option("--range", help="--cloud: farthest depth in metres, 0 for all.")] = 6.0,
    copy: Annotated[Path | None, typer.Option(metavar="OUT.db", help="Thinned copy of the map to make.")] = None,
    session: Annotated[list[int] | None, typer.Option(help="--copy: only these sessions.")] = None,
    rate: Annotated[float | None, typer.Option(help="--copy: at most so many nodes a second.")] = None,
    start: Annotated[float | None, typer.Option(help="--copy: from so many seconds after the first node on.")] = None,
    end: Annotated[float | None, typer.Option(help="--copy: up to so many seconds after the first node.")] = None,
    no_images: Annotated[bool, typer.Option("--no-images", help="--copy: without colour and depth images.")] = False,
    force: ForceOption = False,
) -> None:
    """Write poses, floor plan, cloud, GPS readings, landmarks, images, or a thinned copy: whatever is named."""
    from slam.database import MapReader
    from slam.tools import poses as tool

    if not (poses or grid or cloud or gps or landmarks or images or copy):
        ways = "--poses, --grid, --cloud, --gps, --landmarks, --images or --copy"
        raise DatabaseError(f"nothing to export is named: {ways}")
    for out in (poses, grid, cloud, gps, landmarks):
        if out is not None and out.exists() and out.samefile(path):
            raise DatabaseError(f"{out} is the map itself: choose another name")
    reader = MapReader(path)
    if gps is not None:
        from slam.tools.gps import export_gps

        typer.echo(f"{export_gps(reader, gps)} GPS readings written to {gps}", err=True)
    if landmarks is not None:
        typer.echo(f"{tool.export_landmarks(reader, landmarks)} landmarks written to {landmarks}", err=True)
    if poses is not None:
        count = tool.export_poses(
            reader, poses, tool.Format(format), tool.Whose(frame), tool.Which(which), tool.Every(every)
        )
        typer.echo(f"{count} poses written to {poses}", err=True)
    if grid is not None or cloud is not None:
        _export_shapes(reader, grid, cloud, voxel, range_m)
    if images is not None:
        from slam.tools.images import export_images

        typer.echo(f"{export_images(reader, images)} images written to {images}", err=True)
    if copy is not None:
        from slam.tools.thin import Thinning, thin

        kept = thin(path, copy, Thinning(tuple(session or ()), rate, start, end, images=not no_images), force=force)
        typer.echo(f"{kept.nodes} of {kept.of} nodes copied to {copy}, {kept.bridges} links bridge gaps", err=True)


def _export_shapes(reader: MapReader, grid: Path | None, cloud: Path | None, voxel_m: float, range_m: float) -> None:
    """What stands around the path: floor plan and cloud, by the optimised poses."""
    from slam.graph.graph import PoseGraph

    nodes = PoseGraph.from_reader(reader).poses
    if grid is not None:
        from slam.tools.floor_plan import export_floor_plan

        rows, columns = export_floor_plan(reader, grid, nodes).cells.shape
        typer.echo(f"floor plan of {columns} x {rows} cells written to {grid}, with {grid.stem}.yaml", err=True)
    if cloud is not None:
        from slam.tools.cloud import export_cloud

        typer.echo(f"{export_cloud(reader, cloud, nodes, voxel_m, range_m)} points written to {cloud}", err=True)
