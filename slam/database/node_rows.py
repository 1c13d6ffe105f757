"""Rows of the table Node."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from sqlalchemy import Connection, case, func, insert, select, update

from slam.database.blobs import NOTHING, pack_transform, stack_transforms, unpack_transform
from slam.database.rows import NodeRow, NodeTable
from slam.database.tables import data, feature, node
from slam.errors import DatabaseError
from slam.types import Node


def insert_node(
    connection: Connection, item: Node, label: str | None, stored: Mapping[str, object] = MappingProxyType({})
) -> None:
    """Add a node, with the columns that it takes over."""
    connection.execute(
        insert(node).values(
            id=item.id,
            map_id=item.map_id,
            weight=item.weight,
            stamp=item.stamp,
            pose=pack_transform(item.T_odom_base),
            ground_truth_pose=pack_transform(item.T_world_base),
            label=label,
            **stored,
        )
    )


def first_label(connection: Connection, map_id: int) -> str | None:
    """Label of the next node: ``map<k>`` for the first of its session, as in RTAB-Map, when that name is free."""
    label = f"map{map_id}"
    # Sessions follow each other: the last node tells whether this one has begun, without a look at all of them.
    last = connection.scalar(select(node.c.map_id).order_by(node.c.id.desc()).limit(1))
    taken = connection.execute(select(node.c.id).where(node.c.label == label).limit(1)).first()
    return label if last != map_id and taken is None else None


def update_weights(connection: Connection, weights: Mapping[int, int]) -> None:
    """Give older nodes new weights.

    Raises:
        DatabaseError: a node does not exist.
    """
    for node_id, weight in weights.items():
        done = connection.execute(update(node).where(node.c.id == node_id).values(weight=weight))
        if done.rowcount != 1:
            raise DatabaseError(f"weight {weight} of node {node_id} can't be stored: there is no such node")


def update_labels(connection: Connection, labels: Mapping[int, str | None]) -> None:
    """Give nodes labels, or take theirs away (None).

    Raises:
        DatabaseError: a node does not exist, or another one has the label.
    """
    for node_id, label in labels.items():
        other = connection.scalar(select(node.c.id).where((node.c.label == label) & (node.c.id != node_id)))
        if label is not None and other is not None:
            raise DatabaseError(f"label {label!r} can't be given to node {node_id}: node {other} has it")
        if connection.execute(update(node).where(node.c.id == node_id).values(label=label)).rowcount != 1:
            raise DatabaseError(f"label {label!r} can't be given to node {node_id}: there is no such node")


def read_node_ids(connection: Connection) -> set[int]:
    """All ids, merged and dropped nodes included."""
    return set(connection.scalars(select(node.c.id)))


def read_nodes(connection: Connection) -> NodeTable:
    """All nodes as columns, ascending by id; nothing of their data."""
    columns = (
        node.c.id,
        node.c.map_id,
        node.c.weight,
        node.c.stamp,
        node.c.pose,
        node.c.ground_truth_pose,
        node.c.label,
    )
    rows = connection.execute(select(*columns).order_by(node.c.id)).all()
    ids, map_ids, weights, stamps, odom, world, labels = zip(*rows, strict=True) if rows else ((),) * 7
    return NodeTable(
        ids=np.array(ids, dtype=np.int32),
        map_ids=np.array(map_ids, dtype=np.int32),
        weights=np.array([w or 0 for w in weights], dtype=np.int32),
        stamps=np.array([s or 0.0 for s in stamps], dtype=np.float64),
        T_odom=stack_transforms(odom),
        T_world=stack_transforms(world),
        labels=tuple(labels),
    )


def read_node(connection: Connection, node_id: int) -> NodeRow:
    """One node in full.

    Raises:
        DatabaseError: it is not in the map.
    """
    lengths = (func.coalesce(func.length(c), 0) for c in (data.c.image, data.c.depth))
    sizes = [case((length > NOTHING, length), else_=0) for length in lengths]
    grid = func.coalesce(data.c.cell_size, 0.0) > 0
    query = select(node, *sizes, grid).outerjoin(data, data.c.id == node.c.id).where(node.c.id == node_id)
    row = connection.execute(query).first()
    if row is None:
        raise DatabaseError(f"node {node_id} is not in the map")
    counted = select(func.count(), func.count().filter(feature.c.word_id > 0)).where(feature.c.node_id == node_id)
    features, words = connection.execute(counted).one()
    image_bytes, depth_bytes, has_grid = row[-3:]
    return NodeRow(
        id=row.id,
        map_id=row.map_id,
        weight=row.weight or 0,
        stamp=row.stamp or 0.0,
        label=row.label,
        T_odom_base=unpack_transform(row.pose),
        T_world_base=unpack_transform(row.ground_truth_pose),
        features=features,
        words=words,
        image_bytes=image_bytes,
        depth_bytes=depth_bytes,
        has_grid=bool(has_grid),
    )
