"""The columns of a node that a replay hands on untouched."""

from __future__ import annotations

from sqlalchemy import Connection, Table, select

from slam.database.tables import data, node

_NODE = ("velocity", "gps", "env_sensors")
_IMAGES = ("image", "depth", "calibration", "scan", "scan_info", "user_data")
_GRID = ("ground_cells", "obstacle_cells", "empty_cells", "cell_size", "view_point_x", "view_point_y", "view_point_z")


def read_stored_columns(connection: Connection, node_id: int) -> tuple[dict[str, object], dict[str, object]]:
    """Columns of the tables Node and Data by name, those that hold something, of one node.

    Older schemas are presented as today's, so that what they hold is written as today's.
    """
    return _columns(connection, node, _NODE, node_id), _columns(connection, data, (*_IMAGES, *_GRID), node_id)


def _columns(connection: Connection, table: Table, names: tuple[str, ...], node_id: int) -> dict[str, object]:
    row = connection.execute(select(*(table.c[name] for name in names)).where(table.c.id == node_id)).first()
    return {} if row is None else {name: value for name, value in row._mapping.items() if value is not None}
