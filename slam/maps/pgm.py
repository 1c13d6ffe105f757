"""Occupancy grids as PGM image and YAML, the format of ROS map_server (http://wiki.ros.org/map_server)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slam.saving import save
from slam.types import OccupancyGrid

_OCCUPIED, _FREE, _UNKNOWN = 0, 254, 205
_YAML = """image: {image}
mode: trinary
resolution: {size}
origin: [{x}, {y}, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def write_pgm(path: Path, grid: OccupancyGrid) -> Path:
    """Write ``path`` as binary PGM and beside it the YAML that map_server loads; returns the YAML's path.

    The image's first row is the grid's last (largest y); occupied is 0, free 254, unknown 205.

    Raises:
        DatabaseError: a file can't be written.
    """
    save(path, as_pgm(grid))
    yaml = path.with_suffix(".yaml")
    save(yaml, as_yaml(grid, path.name))
    return yaml


def as_pgm(grid: OccupancyGrid) -> bytes:
    """The image, as ``write_pgm`` has it."""
    shades = np.where(grid.cells < 0, _UNKNOWN, np.where(grid.cells >= 50, _OCCUPIED, _FREE)).astype(np.uint8)
    header = f"P5\n{shades.shape[1]} {shades.shape[0]}\n255\n".encode("ascii")
    return header + shades[::-1].tobytes()


def as_yaml(grid: OccupancyGrid, image: str) -> str:
    """What map_server must know of the image file of this name."""
    return _YAML.format(image=image, size=repr(grid.cell_size), x=repr(grid.x_min), y=repr(grid.y_min))
