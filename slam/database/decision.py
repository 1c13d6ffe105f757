"""Writing people's decisions with all that it changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sqlalchemy import Connection

from slam.database.admin_rows import clear_derived, write_grid
from slam.database.candidate_rows import insert_candidates
from slam.database.journal_rows import append_together
from slam.database.link_rows import update_information
from slam.database.node_record import KnownIds
from slam.database.parameter_rows import change_parameters, log_parameters
from slam.database.pose_rows import read_last, read_poses, replace_poses
from slam.database.poses_before import insert_poses_before
from slam.database.records import JournalEntry
from slam.database.removed_links import put_in, take_out
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
    *,
    in_session: bool = False,
) -> list[int]:
    """Journal, nodes, links, candidates, poses, parameters; what was made from the old graph goes.

    A session that runs (``in_session``) writes its parameters when it ends: until then a change is logged alone.
    Returns the entries' numbers.
    """
    numbers = append_together(connection, entries)
    # Rows whose transforms stay are not made anew: both directions keep every bit, and what else they hold.
    weighed = _weighed(entries)
    for from_id, to_id in remove:
        if (from_id, to_id) not in weighed:
            take_out(connection, numbers[0], from_id, to_id)
    for link in add:
        known.check_link(link)
        if (link.from_id, link.to_id) in weighed:
            update_information(connection, link)
        else:
            put_in(connection, numbers[0], link)
    if poses:
        insert_poses_before(connection, numbers[0], read_poses(connection), poses)
        replace_poses(connection, poses, _last(connection, entries))
    settings = {entry.setting.name: entry.setting.after for entry in entries if entry.setting is not None}
    if settings and in_session:
        log_parameters(connection, settings)
    elif settings:
        change_parameters(connection, settings)
    for item in candidates:
        insert_candidates(connection, max(item.from_id, item.to_id), [item])
    if add or remove or any(_moves_much(entry) for entry in entries):
        clear_derived(connection)
    elif any(entry.grids is not None for entry in entries):
        write_grid(connection, None)
    return numbers


def _moves_much(entry: JournalEntry) -> bool:
    return entry.placement is not None or (entry.node is not None and entry.node.drops)


def _last(connection: Connection, entries: Sequence[JournalEntry]) -> Pose | None:
    """Where the robot was last, in a map that is moved as it is; None leaves what is stored."""
    moves = [entry.placement.T_new_old for entry in entries if entry.placement is not None]
    last = read_last(connection)
    return moves[0] @ last if last is not None and moves and moves[0] is not None else None


def _weighed(entries: Sequence[JournalEntry]) -> set[tuple[int, int]]:
    """Both ids of the links that only get another information matrix."""
    found = set()
    for entry in entries:
        before, after = entry.link_before, entry.link_after
        if before is None or after is None or before.T_from_to is None or after.T_from_to is None:
            continue
        ends = before.from_id, before.to_id
        same = before.type is after.type and ends == (after.from_id, after.to_id)
        if same and np.array_equal(before.T_from_to, after.T_from_to):
            found.add(ends)
    return found
