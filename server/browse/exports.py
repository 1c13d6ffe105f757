"""Files made from a map for download."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Literal

from slam.database import MapReader
from slam.tools.poses import Format, export_poses

PoseFormat = Literal["tum", "kitti", "g2o"]


def pose_file(reader: MapReader, name: str, format: PoseFormat) -> tuple[str, str]:
    """Name and text of a file with the map's poses; raises DatabaseError when it has none."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "poses"
        export_poses(reader, path, Format(format))
        return f"{name}.{'g2o' if format == 'g2o' else f'{format}.txt'}", path.read_text(encoding="utf-8")
