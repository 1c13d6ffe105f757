"""Rows of deck_frame: the pose of every frame, hung on the last node before it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sqlalchemy import Connection, select

from slam.database.blobs import pack_pose, unpack_poses
from slam.database.deck_tables import frame
from slam.database.deck_values import LostFrame
from slam.database.faults import Faults, each_sound, number_of, text_of, whole_of
from slam.database.insertion import insert_rows
from slam.types import TrackedFrame

_COLUMNS = tuple(c for c in frame.c.keys() if c != "id")  # noqa: SIM118 (columns, not a dictionary)


def insert_frames(connection: Connection, map_id: int, frames: Iterable[TrackedFrame]) -> None:
    """Add tracked frames of a session."""
    rows = [
        (
            map_id,
            item.index,
            item.stamp,
            item.node_id,
            pack_pose(item.T_node_base),
            pack_pose(item.T_world_base),
            item.inliers,
            item.odometry_ms,
            item.lost,
        )
        for item in frames
    ]
    insert_rows(connection, frame, _COLUMNS, rows)


def read_frames(connection: Connection, faults: Faults | None = None) -> list[TrackedFrame]:
    """All tracked frames, in the order of time. Rows that make no sense go to ``faults``."""
    rows = list(each_sound(frame.name, connection.execute(select(frame).order_by(frame.c.id)), _checked, faults))
    T_node_base = unpack_poses([row.T_node_base for row in rows])
    T_world_base = unpack_poses([row.T_world_base for row in rows])
    return [
        TrackedFrame(
            index=row.frame_index,
            stamp=row.stamp,
            node_id=row.node_id,
            T_node_base=T_node,
            T_world_base=T_world,
            inliers=row.inliers,
            odometry_ms=row.odometry_ms,
            lost=row.lost,
        )
        for row, T_node, T_world in zip(rows, T_node_base, T_world_base, strict=True)
    ]


def read_lost_frames(connection: Connection, faults: Faults | None = None) -> list[LostFrame]:
    """The frames that odometry lost, in the order of time. Rows that make no sense go to ``faults``."""
    query = select(frame.c.id, frame.c.node_id, frame.c.stamp, frame.c.lost).where(frame.c.lost != "")
    return list(each_sound(frame.name, connection.execute(query.order_by(frame.c.id)), _lost, faults))


def _lost(row: Any) -> LostFrame:
    return LostFrame(whole_of(row.node_id, "node_id"), number_of(row.stamp, "stamp"), text_of(row.lost, "lost"))


def _checked(row: Any) -> Any:
    for name in ("frame_index", "node_id", "inliers"):
        whole_of(getattr(row, name), name)
    for name in ("stamp", "odometry_ms"):
        number_of(getattr(row, name), name)
    text_of(row.lost, "lost")
    return row
