"""``slamdeck export``: poses for other tools."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Format(StrEnum):
    """Text formats of trajectories and graphs."""

    TUM = "tum"
    KITTI = "kitti"
    G2O = "g2o"


class PoseOf(StrEnum):
    """Whose path is written."""

    CAM = "cam"
    BASE = "base"


def export(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="A map file.")],
    poses: Annotated[Path, typer.Option(metavar="OUT", help="Text file to write.")],
    format: Annotated[Format, typer.Option(help="Trajectory as TUM or KITTI, or the graph as g2o.")] = Format.TUM,
    frame: Annotated[PoseOf, typer.Option(help="Path of the camera's optical frame, or of the base.")] = PoseOf.CAM,
) -> None:
    """Write the optimised path of all frames, or the graph."""
    from server.exporting import export_poses
    from slam.database import MapReader

    count = export_poses(MapReader(path), poses, format.value, frame.value)
    typer.echo(f"{count} poses written to {poses}", err=True)
