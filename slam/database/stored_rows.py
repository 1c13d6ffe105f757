"""The columns of a node that a replay hands on untouched."""

from __future__ import annotations

from sqlalchemy import Connection, Table, select

from slam.database.admin_rows import read_version
from slam.database.tables import data, node

_NODE = ("velocity", "gps", "env_sensors")
#: Since this version calibration and scans are what is written today.
_SAME_BLOBS = (0, 18)
_IMAGES = ("image", "depth")
_SINCE = ("calibration", "scan", "scan_info", "user_data")
_GRID = ("ground_cells", "obstacle_cells", "empty_cells", "cell_size", "view_point_x", "view_point_y", "view_point_z")


def read_stored_columns(connection: Connection, node_id: int) -> tuple[dict[str, object], dict[str, object]]:
    """Columns of the tables Node and Data by name, those that hold something, of one node.

    Files before 0.18 have other calibrations and scans: only their images are taken over as they are.
    """
    major, minor = (int(part) for part in read_version(connection).split(".")[:2])
    same = (major, minor) >= _SAME_BLOBS
    of_node = _columns(connection, node, _NODE, node_id) if same else {}
    return of_node, _columns(connection, data, (*_IMAGES, *_SINCE, *_GRID) if same else _IMAGES, node_id)


def _columns(connection: Connection, table: Table, names: tuple[str, ...], node_id: int) -> dict[str, object]:
    row = connection.execute(select(*(table.c[name] for name in names)).where(table.c.id == node_id)).first()
    return {} if row is None else {name: value for name, value in row._mapping.items() if value is not None}
