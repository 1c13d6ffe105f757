"""The one row of the table Admin: version, optimised poses, global grid."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sqlalchemy import Connection, null, select, update

from slam.database.blobs import (
    pack_matrix,
    pack_transform,
    pack_transforms,
    stack_rows,
    unpack_matrix,
    unpack_transform,
)
from slam.database.faults import cell_size_of, number_of, text_of
from slam.database.tables import admin
from slam.errors import DatabaseError
from slam.geometry import Pose
from slam.types import OccupancyGrid

#: Stored, not compressed: for 10,000 poses that saves 13 ms at each decision and costs a tenth in size.
_STORED = 0
_MESH = ("opt_cloud", "opt_polygons_size", "opt_polygons", "opt_tex_coords", "opt_tex_materials")
_GRID = ("opt_map", "opt_map_x_min", "opt_map_y_min", "opt_map_resolution")


def read_version(connection: Connection) -> str:
    """Version of the schema; DatabaseError unless the table has exactly one row."""
    versions = connection.scalars(select(admin.c.version)).all()
    if len(versions) != 1:
        raise DatabaseError(
            f"table Admin has {len(versions)} rows, and exactly one is right: this is no map, or a damaged one"
        )
    return text_of(versions[0], "its version")[:100]


def write_poses(connection: Connection, poses_map_base: Mapping[int, Pose], last: Pose | None) -> None:
    """Replace the optimised poses T_map_base; ``last`` is where the robot is now (None leaves what is stored)."""
    ids, poses = packed_poses(poses_map_base)
    values = {"opt_ids": ids, "opt_poses": poses}
    if last is not None:
        values["opt_last_localization"] = pack_transform(last)
    connection.execute(update(admin).values(values))


def read_poses(connection: Connection) -> dict[int, Pose]:
    """Optimised poses T_map_base by node id (landmarks negative); empty when none are stored."""
    row = connection.execute(select(admin.c.opt_ids, admin.c.opt_poses)).one()
    return unpacked_poses(row.opt_ids, row.opt_poses, admin.name)


def packed_poses(poses_map_base: Mapping[int, Pose]) -> tuple[bytes | None, bytes | None]:
    """Ids and poses as two matrices, by their ids, in single precision; None of no pose."""
    ids = sorted(poses_map_base)
    poses = pack_transforms([poses_map_base[i] for i in ids])
    return pack_matrix(np.array([ids], dtype=np.int32), level=_STORED), pack_matrix(poses, level=_STORED)


def unpacked_poses(packed_ids: bytes | None, packed: bytes | None, table: str) -> dict[int, Pose]:
    """What ``packed_poses`` packed; DatabaseError names the table where both don't fit."""
    ids, poses = unpack_matrix(packed_ids), unpack_matrix(packed)
    if ids is None or poses is None:
        return {}
    if poses.size != 12 * ids.size:
        raise DatabaseError(
            f"{table} has {ids.size} ids and {poses.size} numbers of poses, not 12 for each: the file is damaged"
        )
    with np.errstate(over="ignore"):
        stack = stack_rows(poses.astype(np.float32).ravel())
    pairs = zip(ids.ravel().tolist(), stack, strict=True)
    return {int(node_id): T_map_base for node_id, T_map_base in pairs if not np.isnan(T_map_base[0, 0])}


def read_last(connection: Connection) -> Pose | None:
    """Where the robot was last, T_map_base; None when it is not stored."""
    return unpack_transform(connection.scalar(select(admin.c.opt_last_localization)))


def write_grid(connection: Connection, grid: OccupancyGrid | None) -> None:
    """Replace the global grid; None removes it."""
    values: tuple[bytes | float | None, ...] = (None,) * len(_GRID)
    if grid is not None and grid.cells.size:
        values = (pack_matrix(grid.cells.astype(np.int8)), grid.x_min, grid.y_min, grid.cell_size)
    connection.execute(update(admin).values(dict(zip(_GRID, values, strict=True))))


def read_grid(connection: Connection) -> OccupancyGrid | None:
    """The global grid; None when none is stored."""
    row = connection.execute(select(*(admin.c[name] for name in _GRID))).one()
    cells = unpack_matrix(row.opt_map)
    if cells is None or not row.opt_map_resolution:
        return None
    if cells.ndim != 2:
        raise DatabaseError(f"Admin has a grid of shape {cells.shape}, not one of rows and columns: it is damaged")
    x_min, y_min = number_of(row.opt_map_x_min, "opt_map_x_min"), number_of(row.opt_map_y_min, "opt_map_y_min")
    with np.errstate(invalid="ignore"):
        return OccupancyGrid(
            cells.astype(np.int8), x_min, y_min, cell_size_of(row.opt_map_resolution, "opt_map_resolution")
        )


def forget_dictionary_index(connection: Connection) -> None:
    """Remove RTAB-Map's saved search index over the words (0.23): it would not know new ones, and is made anew."""
    columns = connection.exec_driver_sql("PRAGMA table_info(Admin)").all()
    if any(column.name == "dictionary_index" for column in columns):
        connection.exec_driver_sql("UPDATE Admin SET dictionary_index = NULL")


def clear_derived(connection: Connection) -> None:
    """Remove what was made from the graph as it was: grid, cloud and mesh."""
    connection.execute(update(admin).values({name: null() for name in (*_GRID, *_MESH)}))
