"""The floor plan of a map for navigation: the stored one, or where there is none the local grids put together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slam.database import MapReader
from slam.errors import DatabaseError, ParameterError
from slam.geometry import Pose
from slam.maps.global_grid import GlobalGrid
from slam.maps.pgm import write_pgm
from slam.tools.parameters import taken
from slam.types import LocalGrid, OccupancyGrid

#: A plan of more cells has a pose or a grid that makes no sense.
_MOST_CELLS = 64_000_000


def export_floor_plan(reader: MapReader, path: Path, poses: Mapping[int, Pose]) -> OccupancyGrid:
    """Write the floor plan as PGM, and beside it the YAML that map_server loads.

    Returns:
        What was written.

    Raises:
        DatabaseError: the name does not end in .pgm, the map has no grid, or a file can't be written.
    """
    if path.suffix.lower() != ".pgm":
        raise DatabaseError(f"{path}: a floor plan is a .pgm file, and a .yaml file beside it")
    grid = floor_plan(reader, poses)
    write_pgm(path, grid)
    return grid


def floor_plan(reader: MapReader, poses: Mapping[int, Pose]) -> OccupancyGrid:
    """The global grid as it is stored, else made of the nodes' local grids at these poses (id -> ``T_map_base``).

    Raises:
        DatabaseError: there is neither, or one is damaged.
    """
    stored = reader.grid()
    made = _assembled(reader, poses) if stored is None or not stored.cells.size else stored
    if made is None:
        raise DatabaseError(f"{reader.path}: neither the map nor a node has a grid, there is no floor plan to export")
    return made


def _assembled(reader: MapReader, poses: Mapping[int, Pose]) -> OccupancyGrid | None:
    nodes = [i for i in reader.nodes_with_grid().tolist() if i in poses]
    found = {i: (local, poses[i]) for i in nodes if (local := reader.local_grid(i)) is not None}
    if not found:
        return None
    size = next(iter(found.values()))[0].cell_size
    try:
        params = taken(reader).params.changed({"Grid/CellSize": size})
    except ParameterError as error:
        raise DatabaseError(f"{reader.path}: local grids with cells of {size:g} m: {error}") from error
    sides = _sides(found)
    if not np.prod(sides / size) <= _MOST_CELLS:
        raise DatabaseError(
            f"{reader.path}: a floor plan of {sides[0]:.0f} x {sides[1]:.0f} m is more than it can hold"
        )
    grid = GlobalGrid(params)
    grid.add_all(found)
    return grid.occupancy()


def _sides(grids: Mapping[int, tuple[LocalGrid, Pose]]) -> NDArray[np.float64]:
    """Sides (2,) in metres of what local grids at these poses reach at most."""
    places = np.array([T[:2, 3] for _, T in grids.values()])
    reach = np.array([np.abs(np.vstack([g.ground, g.obstacles, g.empty])).max(initial=0.0) for g, _ in grids.values()])
    around = np.sqrt(2.0) * reach[:, None]
    return np.asarray((places + around).max(axis=0) - (places - around).min(axis=0))
