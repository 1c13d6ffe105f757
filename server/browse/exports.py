"""Files made from a map for download."""

from __future__ import annotations

import io
import tempfile
import zipfile
from contextlib import ExitStack
from pathlib import Path
from typing import Literal

from server.browse.map_view import MapView
from slam.database import MapReader
from slam.maps.pgm import as_pgm, as_yaml
from slam.tools.cloud import export_cloud
from slam.tools.floor_plan import floor_plan
from slam.tools.poses import Format, Which, export_poses

PoseFormat = Literal["tum", "tum-id", "rgbd-slam", "raw", "kitti", "toro", "g2o", "kml"]
WhichPoses = Literal["optimized", "odometry", "truth"]
#: Formats that are known by their own ending.
_OWN_ENDING = ("g2o", "kml")


def pose_file(reader: MapReader, name: str, format: PoseFormat, which: WhichPoses) -> tuple[str, str]:
    """Name and text of a file with a map's poses; raises DatabaseError when it has none."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "poses"
        export_poses(reader, path, Format(format), which=Which(which))
        ending = format if format in _OWN_ENDING else f"{format}.txt"
        kind = "" if which == "optimized" else f".{which}"
        return f"{name}{kind}.{ending}", path.read_text(encoding="utf-8")


def grid_archive(view: MapView) -> bytes:
    """The floor plan as a ZIP of the PGM and the YAML that map_server loads; DatabaseError when there is none."""
    grid, name = floor_plan(view.reader, view.snapshot().poses), view.file.id
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as files:
        files.writestr(f"{name}.pgm", as_pgm(grid))
        files.writestr(f"{name}.yaml", as_yaml(grid, f"{name}.pgm"))
    return archive.getvalue()


def cloud_file(view: MapView, voxel_m: float, range_m: float) -> Path:
    """A new temporary PLY file of the map's cloud, which the caller removes; DatabaseError when there is none."""
    with tempfile.NamedTemporaryFile(suffix=".ply", delete=False) as made:
        path = Path(made.name)
    with ExitStack() as failed:
        failed.callback(path.unlink)
        export_cloud(view.reader, path, view.snapshot().poses, voxel_m, range_m)
        failed.pop_all()
    return path
