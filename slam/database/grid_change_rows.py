"""Local grids that decisions made anew: those from before are kept as they were, so that undo puts back every bit.

Data and deck_local_grid exchange rows: what is not in the one is in the other, and redo is the same exchange again.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, insert, inspect, literal, select, update

from slam.database.data_rows import grid_columns
from slam.database.deck_tables import grid_change, kept_grid
from slam.database.faults import Faults, each_sound, whole_of
from slam.database.records import GridChange
from slam.database.tables import data
from slam.errors import DatabaseError

_COLUMNS = (
    "ground_cells",
    "obstacle_cells",
    "empty_cells",
    "cell_size",
    "view_point_x",
    "view_point_y",
    "view_point_z",
)


def write_grids(connection: Connection, number: int, change: GridChange) -> None:
    """Carry out what entry ``number`` of the journal does to local grids."""
    of = change.of or number
    connection.execute(insert(grid_change).values(id=number, of=of, nodes=change.nodes))
    for node_id, grid in sorted(change.made.items()):
        here = select(literal(of), data.c.id, *(data.c[name] for name in _COLUMNS)).where(data.c.id == node_id)
        connection.execute(insert(kept_grid).from_select(["of", "node_id", *_COLUMNS], here))
        _put(connection, node_id, grid_columns(grid))
    if not change.made:
        _exchange(connection, of)


def read_grid_changes(connection: Connection, faults: Faults | None = None) -> Mapping[int, GridChange]:
    """All changes by the number of their entry; none in files that were written before there were any.

    Rows that make no sense go to ``faults``.
    """
    if not inspect(connection).has_table(grid_change.name):
        return {}
    rows = connection.execute(select(grid_change).order_by(grid_change.c.id))
    return dict(each_sound(grid_change.name, rows, _change, faults))


def _exchange(connection: Connection, of: int) -> None:
    columns = [kept_grid.c[name] for name in _COLUMNS]
    nodes = connection.scalars(select(kept_grid.c.node_id).where(kept_grid.c.of == of)).all()
    if not nodes:
        raise DatabaseError(f"the local grids from before decision {of} are not in the file")
    for node_id in nodes:
        row = (kept_grid.c.of == of) & (kept_grid.c.node_id == node_id)
        kept = connection.execute(select(*columns).where(row)).one()._asdict()
        here = connection.execute(select(*(data.c[name] for name in _COLUMNS)).where(data.c.id == node_id)).first()
        if here is None:
            raise DatabaseError(f"node {node_id} has no data any more, so that its local grid can't be put back")
        connection.execute(update(kept_grid).where(row).values(here._asdict()))
        _put(connection, node_id, kept)


def _put(connection: Connection, node_id: int, values: Mapping[str, Any]) -> None:
    if not connection.execute(update(data).where(data.c.id == node_id).values(values)).rowcount:
        raise DatabaseError(f"node {node_id} has no data that a local grid could go with")


def _change(row: Any) -> tuple[int, GridChange]:
    return row.id, GridChange(of=whole_of(row.of, "of"), nodes=whole_of(row.nodes, "nodes"))
