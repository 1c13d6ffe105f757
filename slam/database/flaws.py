"""What a map file lacks or has too much of: the traces of programs that were killed, and of damage."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, Select, func, select

from slam.database.tables import data, feature, info, link, node, word
from slam.types import WEIGHT_INVALID

Pair = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Flaws:
    """Each is empty or 0 in a sound file.

    Attributes:
        one_way: links (from, to) between nodes without their reverse row; markers of merged nodes are no such links.
        dangling: links with a node that is not there.
        unknown_words: words that key points of kept nodes refer to and the dictionary does not have.
        orphan_features: nodes that key points refer to and that are not there.
        orphan_data: rows of the table Data whose node is not there.
        without_pose: kept nodes without an odometry pose.
        no_parameters: whether no session's parameters are stored, so that RTAB-Map loads nothing.
    """

    one_way: tuple[Pair, ...] = ()
    dangling: tuple[Pair, ...] = ()
    unknown_words: tuple[int, ...] = ()
    orphan_features: tuple[int, ...] = ()
    orphan_data: tuple[int, ...] = ()
    without_pose: tuple[int, ...] = ()
    no_parameters: bool = False


def read_flaws(connection: Connection) -> Flaws:
    """Look at all nodes, links and key points of a file."""
    kept = select(node.c.id).where(node.c.weight > WEIGHT_INVALID)
    ids = select(node.c.id)
    words = select(word.c.id)
    used = select(feature.c.word_id).where((feature.c.word_id > 0) & feature.c.node_id.in_(kept)).distinct()
    return Flaws(
        one_way=_one_way(connection),
        dangling=_dangling(connection),
        unknown_words=_ids(connection, used.where(feature.c.word_id.not_in(words))),
        orphan_features=_ids(connection, select(feature.c.node_id).where(feature.c.node_id.not_in(ids)).distinct()),
        orphan_data=_ids(connection, select(data.c.id).where(data.c.id.not_in(ids))),
        without_pose=_ids(connection, kept.where(node.c.pose.is_(None))),
        no_parameters=not connection.scalar(select(func.count(info.c.parameters)).where(info.c.parameters != "")),
    )


def _one_way(connection: Connection) -> tuple[Pair, ...]:
    between = select(link.c.from_id, link.c.to_id, link.c.transform).where(
        (link.c.from_id != link.c.to_id) & (link.c.to_id > 0)
    )
    rows = connection.execute(between).all()
    known = {(row.from_id, row.to_id) for row in rows}
    return tuple(
        sorted(
            (row.from_id, row.to_id)
            for row in rows
            if (row.to_id, row.from_id) not in known and row.transform is not None and any(row.transform)
        )
    )


def _dangling(connection: Connection) -> tuple[Pair, ...]:
    ids = set(connection.scalars(select(node.c.id)))
    rows = connection.execute(select(link.c.from_id, link.c.to_id)).all()
    return tuple(sorted({(a, b) for a, b in rows if a not in ids or (b > 0 and b not in ids)}))


def _ids(connection: Connection, query: Select[tuple[int]]) -> tuple[int, ...]:
    return tuple(sorted(connection.scalars(query)))
