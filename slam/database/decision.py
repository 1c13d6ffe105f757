"""Writing people's decisions with all that it changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sqlalchemy import Connection

from slam.database.admin_rows import clear_derived
from slam.database.journal_rows import append_together
from slam.database.link_rows import insert_link, remove_link
from slam.database.node_record import KnownIds
from slam.database.pose_rows import replace_poses
from slam.database.records import JournalEntry
from slam.geometry import Pose
from slam.types import Link


def write_decision(
    connection: Connection,
    known: KnownIds,
    entries: Sequence[JournalEntry],
    add: Sequence[Link],
    remove: Sequence[tuple[int, int]],
    poses: Mapping[int, Pose],
) -> list[int]:
    """Journal, links, optimised poses; what was made from the old graph goes. Returns the journal's numbers."""
    numbers = append_together(connection, entries)
    for from_id, to_id in remove:
        remove_link(connection, from_id, to_id)
    for link in add:
        known.check_link(link)
        insert_link(connection, link)
    if poses:
        replace_poses(connection, poses, None)
    if add or remove:
        clear_derived(connection)
    return numbers
