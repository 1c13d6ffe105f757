"""The columns of a node that a replay hands on untouched."""

from __future__ import annotations

from sqlalchemy import Connection, Table, select

from slam.database.tables import data, node

_NODE = ("velocity", "gps", "env_sensors")
_IMAGES = ("image", "depth")
_SENSORS = ("calibration", "scan", "scan_info", "user_data")
_GRID = ("ground_cells", "obstacle_cells", "empty_cells", "cell_size", "view_point_x", "view_point_y", "view_point_z")


def read_stored_columns(
    connection: Connection, node_id: int, *, images: bool = True
) -> tuple[dict[str, object], dict[str, object]]:
    """Columns of the tables Node and Data by name, those that hold something, of one node.

    Images are among them unless ``images`` is false. Older schemas are presented as today's, so that what they hold is
    written as today's.
    """
    of_data = (*(_IMAGES if images else ()), *_SENSORS, *_GRID)
    return _columns(connection, node, _NODE, node_id), _columns(connection, data, of_data, node_id)


def _columns(connection: Connection, table: Table, names: tuple[str, ...], node_id: int) -> dict[str, object]:
    row = connection.execute(select(*(table.c[name] for name in names)).where(table.c.id == node_id)).first()
    return {} if row is None else {name: value for name, value in row._mapping.items() if value is not None}
