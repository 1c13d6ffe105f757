"""What people should know of a map file before they look at it: what is missing, what was made up for."""

from __future__ import annotations

from collections.abc import Iterator

from server.browse.snapshot import Snapshot
from slam.database.file_check import OLDEST_WRITTEN, is_writable


def notes(snapshot: Snapshot, *, clean: bool, live: bool) -> list[str]:
    """Sentences, the gravest first; none for a map that is whole."""
    if live or not len(snapshot.all_nodes):
        return []
    return [*_ending(snapshot, clean), *_poses(snapshot), *_age(snapshot)]


def _ending(snapshot: Snapshot, clean: bool) -> Iterator[str]:
    if not clean:
        yield "The last session was not closed in order: what its program held in memory at the end is missing."
    one_way = snapshot.reader.one_way_links()
    if one_way:
        yield f"Links between neighbours that are stored in one direction only, and used all the same: {one_way}."
    if not snapshot.reader.parameters():
        yield "It does not say with what parameters it was made: the defaults are shown."


def _poses(snapshot: Snapshot) -> Iterator[str]:
    done = snapshot.completion
    if done.failure is not None:
        yield f"Optimised poses are missing and can't be computed, odometry is shown: {done.failure}"
    count = len(snapshot.rows.keys() & done.poses.keys())
    if count:
        which = f"{count} nodes lack optimised poses" if snapshot.stored_poses else "No optimised poses are stored"
        yield f"{which}: they are computed from the links, and not written."
    if done.failure is None:
        alone = len((snapshot.rows.keys() & snapshot.poses.keys()) - snapshot.stored_poses.keys() - done.poses.keys())
        if alone:
            yield f"Nodes without links and optimised poses, shown where odometry has them: {alone}."
    lost = [node_id for node_id in snapshot.rows if node_id not in snapshot.poses]
    if lost:
        yield f"Nodes without any pose, even of odometry, which are not drawn: {len(lost)} (first: {lost[0]})."


def _age(snapshot: Snapshot) -> Iterator[str]:
    if not is_writable(snapshot.reader.version):
        oldest = f"{OLDEST_WRITTEN[0]}.{OLDEST_WRITTEN[1]}"
        yield f"Files of RTAB-Map before {oldest} can be looked at, but not changed."
