"""Rows of deck_pose: optimised poses that changed since all of them were last written to the table Admin.

RTAB-Map keeps the poses of the whole map in one blob of one row. Writing that at every node would cost more the larger
the map is; so what an update changes is put beside it, and taken into it when the session ends.
"""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import Connection, delete, inspect, select

from slam.database import admin_rows
from slam.database.blobs import pack_pose, unpack_poses
from slam.database.deck_tables import pose
from slam.geometry import Pose

#: Stands for the robot itself; nodes have positive ids, landmarks negative ones.
_ROBOT = 0


def add_poses(connection: Connection, poses_map_base: Mapping[int, Pose], last: Pose | None) -> None:
    """Poses T_map_base that changed, and where the robot is now (None leaves what is stored)."""
    rows = [(node_id, pack_pose(T)) for node_id, T in poses_map_base.items()]
    rows += [] if last is None else [(_ROBOT, pack_pose(last))]
    if rows:
        connection.exec_driver_sql(f"INSERT OR REPLACE INTO {pose.name} (id, T_map_base) VALUES (?, ?)", rows)


def replace_poses(connection: Connection, poses_map_base: Mapping[int, Pose], last: Pose | None) -> None:
    """All optimised poses; ``last`` is where the robot is now (None leaves what is stored)."""
    admin_rows.write_poses(connection, poses_map_base, read_last(connection) if last is None else last)
    connection.execute(delete(pose))


def merge_poses(connection: Connection) -> None:
    """Take what changed into the table Admin, where RTAB-Map finds it."""
    if connection.execute(select(pose.c.id).limit(1)).first() is not None:
        replace_poses(connection, read_poses(connection), None)


def has_changed(connection: Connection) -> bool:
    """Whether any pose changed since all of them were written."""
    if not inspect(connection).has_table(pose.name):
        return False
    return connection.execute(select(pose.c.id).where(pose.c.id != _ROBOT).limit(1)).first() is not None


def read_poses(connection: Connection) -> dict[int, Pose]:
    """Optimised poses T_map_base by node id (landmarks negative); empty when none are stored."""
    changed = _changed(connection)
    changed.pop(_ROBOT, None)
    return admin_rows.read_poses(connection) | changed


def read_last(connection: Connection) -> Pose | None:
    """Where the robot was last, T_map_base; None when it is not stored."""
    return _changed(connection, only=_ROBOT).get(_ROBOT, admin_rows.read_last(connection))


def _changed(connection: Connection, only: int | None = None) -> dict[int, Pose]:
    if not inspect(connection).has_table(pose.name):
        return {}
    query = select(pose.c.id, pose.c.T_map_base).order_by(pose.c.id)
    rows = connection.execute(query if only is None else query.where(pose.c.id == only)).all()
    found = zip((row.id for row in rows), unpack_poses([row.T_map_base for row in rows]), strict=True)
    return {node_id: T for node_id, T in found if T is not None}
