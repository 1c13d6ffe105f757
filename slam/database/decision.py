"""Writing people's decisions with all that it changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sqlalchemy import Connection

from slam.database.admin_rows import clear_derived
from slam.database.candidate_rows import insert_candidates
from slam.database.journal_rows import append_together
from slam.database.link_rows import insert_link, remove_link
from slam.database.node_record import KnownIds
from slam.database.pose_rows import replace_poses
from slam.database.records import JournalEntry
from slam.geometry import Pose
from slam.types import Candidate, Link


def write_decision(
    connection: Connection,
    known: KnownIds,
    entries: Sequence[JournalEntry],
    add: Sequence[Link],
    remove: Sequence[tuple[int, int]],
    poses: Mapping[int, Pose],
    candidates: Sequence[Candidate] = (),
) -> list[int]:
    """Journal, nodes, links, candidates, poses; what was made from the old graph goes. Returns the entries' numbers."""
    numbers = append_together(connection, entries)
    for from_id, to_id in remove:
        remove_link(connection, from_id, to_id)
    for link in add:
        known.check_link(link)
        insert_link(connection, link)
    if poses:
        replace_poses(connection, poses, None)
    for item in candidates:
        insert_candidates(connection, max(item.from_id, item.to_id), [item])
    if add or remove or any(entry.node is not None and entry.node.drops for entry in entries):
        clear_derived(connection)
    return numbers
