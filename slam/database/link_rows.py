"""Rows of the table Link: each link in both directions, as RTAB-Map keeps it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import ColumnElement, Connection, Table, delete, func, select, text, update

from slam.database.blobs import (
    INFORMATION_BYTES,
    MAX_CLOUD_BYTES,
    NOTHING,
    TRANSFORM_BYTES,
    check_information,
    pack_information,
    pack_transform,
    sound_informations,
    stack_informations,
    stack_transforms,
    unpack_matrix,
)
from slam.database.faults import Faults, blob_of, each_sound, link_type_of, whole_of
from slam.database.insertion import insert_rows
from slam.database.tables import link
from slam.errors import DatabaseError
from slam.geometry import inverse
from slam.types import Link, LinkType

_COLUMNS = ("from_id", "to_id", "type", "information_matrix", "transform")
_SELF = (LinkType.POSE_PRIOR, LinkType.GRAVITY)


def merged_marker(from_id: int, to_id: int) -> Link:
    """The link that says that node ``from_id`` was merged into ``to_id``: no transform, identity information."""
    return Link(from_id, to_id, LinkType.GLOBAL_CLOSURE, None, np.eye(6))


def insert_link(connection: Connection, item: Link) -> None:
    """Add a link, with its reverse where it has one; the reverse keeps the same information matrix.

    Raises:
        DatabaseError: there is one between these nodes already, or RTAB-Map would refuse to load it.
    """
    _check(item)
    if _rows_between(connection, item.from_id, item.to_id, item.type):
        raise DatabaseError(
            f"link {item.from_id}-{item.to_id} exists already: remove it first, two nodes have one link at most"
        )
    information = pack_information(item.information)
    rows = [(item.from_id, item.to_id, int(item.type), information, pack_transform(item.T_from_to))]
    if item.T_from_to is not None and item.from_id != item.to_id and item.to_id > 0:
        rows.append((item.to_id, item.from_id, int(item.type), information, pack_transform(inverse(item.T_from_to))))
    insert_rows(connection, link, _COLUMNS, rows)


def remove_link(connection: Connection, from_id: int, to_id: int) -> None:
    """Remove the link between two nodes, in both directions, or the prior of one; DatabaseError when there is none."""
    if not connection.execute(delete(link).where(that_joins(link, from_id, to_id))).rowcount:
        raise DatabaseError(f"link {from_id}-{to_id} can't be removed: the map has none between these nodes")


def that_joins(table: Table, from_id: int, to_id: int) -> ColumnElement[bool]:
    """The rows of a table of links that are between two nodes, in both directions, or the prior of one."""
    forth = (table.c.from_id == from_id) & (table.c.to_id == to_id)
    if from_id == to_id:
        # Gravity is a link of a node to itself as well: it was measured, and nobody takes it away.
        return forth & (table.c.type == int(LinkType.POSE_PRIOR))
    return forth | ((table.c.from_id == to_id) & (table.c.to_id == from_id))


def update_information(connection: Connection, item: Link) -> None:
    """Give a link another information matrix, in both directions; DatabaseError when there is none."""
    forth = (link.c.from_id == item.from_id) & (link.c.to_id == item.to_id)
    back = (link.c.from_id == item.to_id) & (link.c.to_id == item.from_id)
    rows = (forth | back) & (link.c.type == int(item.type))
    packed = pack_information(item.information)
    if not connection.execute(update(link).where(rows).values(information_matrix=packed)).rowcount:
        raise DatabaseError(f"link {item.from_id}-{item.to_id} can't be changed: the map has none of this type")


def read_links(connection: Connection, faults: Faults | None = None) -> list[Link]:
    """All links, each pair once and from the newer node to the older where the file has that direction.

    Missing reverse rows and duplicates, which files of killed programs have, are tolerated: the last row counts.
    Rows that make no sense go to ``faults``.
    """
    query = select(link.c.from_id, link.c.to_id, link.c.type, link.c.information_matrix, link.c.transform)
    rows = list(each_sound("Link", connection.execute(query.order_by(text("rowid"))), _columns, faults, columns=2))
    ends, informations, transforms = zip(*rows, strict=True) if rows else ((),) * 3
    stack, poses = stack_informations(informations), stack_transforms(transforms)
    known = np.isfinite(poses[:, 0, 0])
    good = sound_informations(stack)
    good[[row for row in np.flatnonzero(~known) if transforms[row] is not None and any(transforms[row])]] = False
    bad = ((*ends[row][:2], stack[row]) for row in np.flatnonzero(~good))
    list(each_sound("Link", bad, _refused, faults, columns=2))
    kept = _one_of_each(np.array(ends, np.int64).reshape(-1, 3), good).tolist()
    found = ((ends[row], poses[row] if known[row] else None, stack[row]) for row in kept)
    return [Link(from_id, to_id, kind, T, information) for (from_id, to_id, kind), T, information in found]


def _one_of_each(numbers: NDArray[np.int64], good: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Of the good rows (N, 3) of ids and type one for each pair: the last from a newer node, else the last.

    A node may have a prior and gravity, both links to itself.
    """
    rows = np.flatnonzero(good)
    from_id, to_id, kind = numbers[rows].T
    keys = np.minimum(from_id, to_id), np.maximum(from_id, to_id), kind == LinkType.GRAVITY
    order = np.lexsort((rows, from_id > to_id, *reversed(keys)))
    last = np.ones(len(order), np.bool_)
    last[:-1] = np.any([key[order][1:] != key[order][:-1] for key in keys], axis=0)
    return rows[order[last]]


def read_link_user_data(connection: Connection, from_id: int, to_id: int) -> NDArray[np.generic] | None:
    """The matrix attached to the link between two nodes, in either direction; None where there is none."""
    ends = ((link.c.from_id == from_id) & (link.c.to_id == to_id)) | (
        (link.c.from_id == to_id) & (link.c.to_id == from_id)
    )
    blobs = connection.scalars(select(link.c.user_data).where(ends & (func.length(link.c.user_data) > NOTHING)))
    return unpack_matrix(blobs.first(), MAX_CLOUD_BYTES)


def count_one_way(connection: Connection) -> int:
    """Number of neighbour links that lack the reverse."""
    steps = link.c.type == int(LinkType.NEIGHBOR)
    forth, back = (
        select(*ends).where(steps) for ends in ((link.c.from_id, link.c.to_id), (link.c.to_id, link.c.from_id))
    )
    return connection.scalar(select(func.count()).select_from(forth.except_(back).subquery())) or 0


def _check(item: Link) -> None:
    name = f"link {item.from_id}-{item.to_id} ({item.type.label})"
    if item.type == LinkType.VIRTUAL_CLOSURE:
        raise DatabaseError(f"{name} can't be stored: virtual links are never saved")
    if (item.from_id == item.to_id) != (item.type in _SELF):
        raise DatabaseError(f"{name} can't be stored: links of a node to itself are priors and gravity, and only those")
    if (item.to_id < 0) != (item.type == LinkType.LANDMARK):
        raise DatabaseError(f"{name} can't be stored: landmarks, and only those, have negative ids")
    if item.T_from_to is not None and not np.all(np.isfinite(item.T_from_to)):
        raise DatabaseError(f"{name} can't be stored: its transform is not finite")


def _rows_between(connection: Connection, from_id: int, to_id: int, kind: LinkType) -> Iterable[int]:
    pair = ((link.c.from_id == from_id) & (link.c.to_id == to_id)) | (
        (link.c.from_id == to_id) & (link.c.to_id == from_id)
    )
    if from_id == to_id:
        pair = pair & (link.c.type == int(kind))
    return connection.scalars(select(link.c.type).where(pair)).all()


def _columns(row: Any) -> tuple[tuple[int, int, LinkType], bytes | None, bytes | None]:
    from_id, to_id, kind, information, transform = row
    for end in (from_id, to_id):
        if whole_of(end, "one of its ids") == 0:
            raise DatabaseError("one of its ids is 0, and nodes begin with 1")
    blobs = (
        blob_of(information, "information matrix", INFORMATION_BYTES),
        blob_of(transform, "transform", TRANSFORM_BYTES),
    )
    return (from_id, to_id, link_type_of(kind)), *blobs


def _refused(named: tuple[int, int, NDArray[np.float64]]) -> NoReturn:
    """Say what is wrong with a row whose information or transform is."""
    check_information(named[-1])
    raise DatabaseError("its transform is no rigid motion of finite numbers")
