"""Rows of deck_node_change: what entries of the journal did to nodes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sqlalchemy import Connection, insert, inspect, select

from slam.database.blobs import pack_pose, unpack_pose
from slam.database.deck_tables import node_change, pose
from slam.database.link_rows import read_links
from slam.database.node_rows import update_labels, update_weights
from slam.database.records import NodeChange
from slam.types import Link


def write_change(connection: Connection, number: int, change: NodeChange) -> None:
    """Change the node, and keep what it was beside entry ``number`` of the journal.

    Raises:
        DatabaseError: there is no such node, or another one has the label.
    """
    connection.execute(
        insert(node_change).values(
            id=number,
            node_id=change.node_id,
            map_id=change.map_id,
            weight_before=change.weight_before,
            weight_after=change.weight_after,
            label_before=change.label_before,
            label_after=change.label_after,
            T_odom_base=pack_pose(change.T_odom_base),
            T_map_base=pack_pose(change.T_map_base),
        )
    )
    if change.weight_after != change.weight_before:
        update_weights(connection, {change.node_id: change.weight_after})
    if change.label_after != change.label_before:
        update_labels(connection, {change.node_id: change.label_after or None})
    if change.drops:
        connection.execute(pose.delete().where(pose.c.id == change.node_id))


def read_changes(connection: Connection) -> Mapping[int, NodeChange]:
    """All changes by the number of their entry; none in files that were written before nodes could be changed."""
    if not inspect(connection).has_table(node_change.name):
        return {}
    rows = connection.execute(select(node_change).order_by(node_change.c.id)).all()
    alone = _constraints(connection, {row.node_id for row in rows}) if rows else {}
    return {
        row.id: NodeChange(
            node_id=row.node_id,
            map_id=row.map_id,
            weight_before=row.weight_before,
            weight_after=row.weight_after,
            label_before=row.label_before,
            label_after=row.label_after,
            T_odom_base=_pose(row.T_odom_base),
            T_map_base=_pose(row.T_map_base),
            constraints=tuple(alone.get(row.node_id, ())),
        )
        for row in rows
    }


def _pose(blob: bytes) -> np.ndarray:
    found = unpack_pose(blob)
    return np.eye(4) if found is None else found


def _constraints(connection: Connection, node_ids: set[int]) -> dict[int, list[Link]]:
    found: dict[int, list[Link]] = {}
    for link in read_links(connection):
        single = link.from_id == link.to_id or link.to_id < 0
        if single and link.from_id in node_ids and link.T_from_to is not None:
            found.setdefault(link.from_id, []).append(link)
    return found
