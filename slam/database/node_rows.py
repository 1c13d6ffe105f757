"""Rows of the table Node."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import Connection, case, func, insert, or_, select, update

from slam.database.blobs import NOTHING, TRANSFORM_BYTES, pack_transform, stack_transforms, unpack_transform
from slam.database.faults import Fault, Faults, blob_of, each_sound, node_id_of, number_of, text_of, whole_of
from slam.database.rows import NodeRow, NodeTable
from slam.database.tables import data, feature, node
from slam.errors import DatabaseError
from slam.types import Node

#: Characters of a label that are read.
LONGEST_LABEL = 1000
#: A row of the table as its columns have it: id, session, weight, stamp, both poses, label.
NodeColumns = tuple[int, int, int, float, bytes | None, bytes | None, str | None]


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


def move_label(connection: Connection, from_id: int, to_id: int) -> None:
    """Give a node the label of another one, which loses it; nothing happens where that has none."""
    label = connection.scalar(select(node.c.label).where(node.c.id == from_id))
    if label is not None:
        for node_id, text in ((from_id, None), (to_id, label)):
            connection.execute(update(node).where(node.c.id == node_id).values(label=text))


def read_node_ids(connection: Connection) -> set[int]:
    """All ids, merged and dropped nodes included."""
    return set(connection.scalars(select(node.c.id)))


def read_nodes(connection: Connection, faults: Faults | None = None) -> NodeTable:
    """All nodes as columns, ascending by id; nothing of their data. Rows that make no sense go to ``faults``."""
    columns = (
        node.c.id,
        node.c.map_id,
        node.c.weight,
        node.c.stamp,
        *(case((func.length(pose) == TRANSFORM_BYTES, pose)) for pose in (node.c.pose, node.c.ground_truth_pose)),
        func.substr(node.c.label, 1, LONGEST_LABEL),
    )
    found = connection.execute(select(*columns).order_by(node.c.id))
    rows = list(each_sound("Node", found, _row_maker(), faults))
    ids, map_ids, weights, stamps, odom, world, labels = zip(*rows, strict=True) if rows else ((),) * 7
    T_odom, T_world = stack_transforms(odom), stack_transforms(world)
    if faults is not None:
        faults |= _unreadable_poses(ids, odom, T_odom, "pose") | _unreadable_poses(ids, world, T_world, "ground truth")
    return NodeTable(
        ids=np.array(ids, dtype=np.int32),
        map_ids=np.array(map_ids, dtype=np.int32),
        weights=np.array(weights, dtype=np.int32),
        stamps=np.array(stamps, dtype=np.float64),
        T_odom=T_odom,
        T_world=T_world,
        labels=tuple(labels),
    )


def _unreadable_poses(
    ids: Iterable[int], blobs: Iterable[bytes | None], stack: NDArray[np.float64], what: str
) -> Faults:
    """Nodes whose pose is given and is none."""
    unknown = np.isnan(stack[:, 0, 0]).tolist()
    named = (i for i, blob, lost in zip(ids, blobs, unknown, strict=True) if lost and blob is not None and any(blob))
    return {
        Fault("Node", str(i), f"its {what} is no rigid motion of finite numbers: it counts as unknown"): None
        for i in named
    }


def _row_maker() -> Callable[[Any], NodeColumns]:
    """Checks rows that come ascending by id."""
    last = 0

    def make(row: Any) -> NodeColumns:
        nonlocal last
        node_id, map_id, weight, stamp, odom, world, label = row
        if node_id_of(node_id) <= last:
            raise DatabaseError(f"there is a node {node_id} already")
        last = node_id
        named = label if label is None else text_of(label, "label")
        numbers = node_id, whole_of(map_id, "map_id"), whole_of(weight, "weight"), number_of(stamp, "stamp")
        return *numbers, *(blob_of(pose, "pose", TRANSFORM_BYTES) for pose in (odom, world)), named

    return make


def read_word_counts(connection: Connection, ids: Sequence[int]) -> dict[int, int]:
    """Id -> number of key points that are words of the dictionary, of those of these nodes that have any."""
    words = select(feature.c.node_id, func.count()).where(feature.c.node_id.in_(ids) & (feature.c.word_id > 0))
    return dict(connection.execute(words.group_by(feature.c.node_id)).all())


def read_node(connection: Connection, node_id: int) -> NodeRow:
    """One node in full.

    Raises:
        DatabaseError: it is not in the map.
    """
    lengths = (func.coalesce(func.length(c), 0) for c in (data.c.image, data.c.depth, data.c.calibration))
    sizes = [case((length > NOTHING, length), else_=0) for length in lengths]
    # Lengths are in a row's head; other columns behind the images would cost reading these.
    cells = (data.c.ground_cells, data.c.obstacle_cells, data.c.empty_cells)
    grid = or_(*(func.coalesce(func.length(column), 0) > NOTHING for column in cells))
    query = select(node, *sizes, grid).outerjoin(data, data.c.id == node.c.id).where(node.c.id == node_id)
    row = connection.execute(query).first()
    if row is None:
        raise DatabaseError(f"node {node_id} is not in the map")
    counted = select(func.count(), func.count().filter(feature.c.word_id > 0)).where(feature.c.node_id == node_id)
    features, words = connection.execute(counted).one()
    image_bytes, depth_bytes, calibration_bytes, has_grid = row[-4:]
    return NodeRow(
        id=row.id,
        map_id=row.map_id,
        weight=whole_of(row.weight, "weight"),
        stamp=number_of(row.stamp, "stamp"),
        label=None if row.label is None else text_of(row.label, "label")[:LONGEST_LABEL],
        T_odom_base=unpack_transform(row.pose),
        T_world_base=unpack_transform(row.ground_truth_pose),
        features=features,
        words=words,
        image_bytes=image_bytes,
        depth_bytes=depth_bytes,
        calibration_bytes=calibration_bytes,
        has_grid=bool(has_grid),
    )
