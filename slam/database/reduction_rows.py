"""What the file says of a node that became part of another one.

Its row and data stay, with weight -9 and its loops or a marker, as RTAB-Map leaves them: nothing points at it.
"""

from __future__ import annotations

from sqlalchemy import Connection, delete, select, update

from slam.database.blobs import pack_pose, unpack_pose
from slam.database.deck_tables import frame, pose
from slam.database.link_rows import insert_link, merged_marker
from slam.database.node_rows import move_label, update_weights
from slam.database.records import Reduction
from slam.database.tables import link
from slam.types import WEIGHT_INVALID, LinkType

_STEPS = (int(LinkType.NEIGHBOR), int(LinkType.NEIGHBOR_MERGED))


def write_reduction(connection: Connection, item: Reduction) -> None:
    """Take a node out of the graph; the frames that hung on it hang on the older node, at the pose that they had."""
    node_id, others = item.node_id, link.c.from_id != link.c.to_id
    connection.execute(delete(link).where((link.c.to_id == node_id) & others))
    own = (link.c.from_id == node_id) & others
    connection.execute(delete(link).where(own if item.marked else own & link.c.type.in_(_STEPS)))
    if item.marked:
        insert_link(connection, merged_marker(node_id, item.into))
        move_label(connection, node_id, item.into)
    for new in item.links:
        insert_link(connection, new)
    update_weights(connection, {node_id: WEIGHT_INVALID})
    connection.execute(delete(pose).where(pose.c.id == node_id))
    for row in connection.execute(select(frame.c.id, frame.c.T_node_base).where(frame.c.node_id == node_id)).all():
        T_node_base = unpack_pose(row.T_node_base)
        T_into_base = None if T_node_base is None else item.T_into_node @ T_node_base
        moved = update(frame).where(frame.c.id == row.id)
        connection.execute(moved.values(node_id=item.into, T_node_base=pack_pose(T_into_base)))
