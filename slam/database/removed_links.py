"""Rows of Link that decisions remove, kept as they were: undo puts them back with every bit, and what is attached.

A link in memory has one direction and no user data; files of other programs have both, rounded in their own way.
"""

from __future__ import annotations

from sqlalchemy import Connection, delete, insert, literal, select, update

from slam.database.blobs import pack_information, pack_transform
from slam.database.deck_tables import removed_link
from slam.database.link_rows import insert_link, remove_link, that_joins
from slam.database.tables import link
from slam.types import Link

_COLUMNS = ("from_id", "to_id", "type", "information_matrix", "transform", "user_data")


def take_out(connection: Connection, number: int, from_id: int, to_id: int) -> None:
    """Remove a link for the decision whose first entry is ``number``; DatabaseError when there is none."""
    rows = select(literal(number), *(link.c[name] for name in _COLUMNS)).where(that_joins(link, from_id, to_id))
    connection.execute(insert(removed_link).from_select(["number", *_COLUMNS], rows))
    remove_link(connection, from_id, to_id)


def put_in(connection: Connection, number: int, item: Link) -> None:
    """Add a link: the rows that it had where it was there before, else new ones. Raises like ``insert_link``.

    One that replaces another in the same decision takes over what was attached to that.
    """
    insert_link(connection, item)
    removed, pair = removed_link.c, that_joins(removed_link, item.from_id, item.to_id)
    same = (removed.from_id == item.from_id) & (removed.to_id == item.to_id) & (removed.type == int(item.type))
    same &= removed.transform == pack_transform(item.T_from_to)
    same &= removed.information_matrix == pack_information(item.information)
    before = connection.scalar(select(removed.number).where(same).order_by(removed.id.desc()).limit(1))
    if before is None:
        attached = select(removed.user_data).where(pair & (removed.number == number) & removed.user_data.is_not(None))
        if (data := connection.scalar(attached)) is not None:
            ends = (link.c.from_id == item.from_id) & (link.c.to_id == item.to_id)
            connection.execute(update(link).where(ends & (link.c.type == int(item.type))).values(user_data=data))
        return
    remove_link(connection, item.from_id, item.to_id)
    rows = select(*(removed[name] for name in _COLUMNS)).where(pair & (removed.number == before)).order_by(removed.id)
    connection.execute(insert(link).from_select(_COLUMNS, rows))
    connection.execute(delete(removed_link).where(pair & (removed.number == before)))
