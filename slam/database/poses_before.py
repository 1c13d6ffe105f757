"""Rows of deck_poses_before: where all nodes were before each of the last decisions, so that undo is exact.

Optimising again would not do: what a prior or a loop between sessions carried off as a whole stays where it is when
the link goes.
"""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256

from sqlalchemy import Connection, delete, func, insert, inspect, select

from slam.database.admin_rows import packed_poses, unpacked_poses
from slam.database.deck_tables import poses_before
from slam.database.pose_rows import read_poses
from slam.geometry import Pose

#: Decisions whose poses are kept: 48 bytes for each node.
_KEPT = 100


def insert_poses_before(
    connection: Connection, number: int, before: Mapping[int, Pose], after: Mapping[int, Pose]
) -> None:
    """Keep the poses before the decision whose first entry is ``number``; those of the oldest decisions go."""
    if not before:
        return
    ids, poses = packed_poses(before)
    row = {"id": number, "ids": ids, "poses": poses, "after": _digest(after)}
    connection.execute(insert(poses_before), row)
    oldest = select(poses_before.c.id).order_by(poses_before.c.id.desc()).offset(_KEPT - 1).limit(1)
    connection.execute(delete(poses_before).where(poses_before.c.id < func.coalesce(oldest.scalar_subquery(), 0)))


def read_poses_before(connection: Connection, number: int) -> dict[int, Pose] | None:
    """T_map_base by node id before the decision whose first entry is ``number``.

    None where they are not kept (any more), or the poses of now are not those that it left.
    """
    if not inspect(connection).has_table(poses_before.name):
        return None
    row = connection.execute(select(poses_before).where(poses_before.c.id == number)).one_or_none()
    if row is None or row.after != _digest(read_poses(connection)):
        return None
    return unpacked_poses(row.ids, row.poses, poses_before.name)


def _digest(poses: Mapping[int, Pose]) -> str:
    ids, stack = packed_poses(poses)
    return sha256((ids or b"") + (stack or b"")).hexdigest()
