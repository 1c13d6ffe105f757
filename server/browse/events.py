"""What happened in the course of a map: the places in its history that are worth going to."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np

from server.browse.snapshot import Pair
from server.browse.timeline import Timeline
from server.schemas import TimelineEvent, TimelineUpdates
from slam.types import Tier

_REJECTED, _PLACE = "Loop/RejectedHypothesis/", "Loop/Highest_hypothesis_id/"
#: Nodes that a text names; of more it says how many.
_NAMED = 4


def updates(timeline: Timeline) -> TimelineUpdates:
    """All updates with what happened in them, oldest first."""
    found = sorted(_events(timeline), key=lambda one: one.at)
    return TimelineUpdates(
        revision=timeline.snapshot.revision,
        ids=timeline.ids,
        stamps=timeline.stamps,
        memory=timeline.knows_memory,
        events=found,
    )


def _events(timeline: Timeline) -> Iterator[TimelineEvent]:
    yield from _sessions(timeline)
    yield from _verdicts(timeline)
    yield from _rejected(timeline)
    yield from _lost(timeline)
    yield from _moves(timeline)


def _sessions(timeline: Timeline) -> Iterator[TimelineEvent]:
    nodes = timeline.snapshot.nodes
    seen: set[int] = set()
    for node_id, map_id in zip(nodes.ids.tolist(), nodes.map_ids.tolist(), strict=True):
        if map_id not in seen:
            seen.add(map_id)
            yield TimelineEvent(at=node_id, kind="session", text=f"session {map_id} begins", pairs=[])


def _verdicts(timeline: Timeline) -> Iterator[TimelineEvent]:
    known = timeline.snapshot.rows.keys()
    for update, verdicts in groupby(timeline.verdicts, key=lambda one: one.update):
        group = [one for one in verdicts if set(one.pair) <= known]
        accepted = [one for one in group if one.accepted]
        refused = [one.pair for one in group if not one.accepted]
        if accepted:
            kinds = ", ".join(sorted({one.type.label for one in accepted}))
            pairs = [one.pair for one in accepted]
            yield TimelineEvent(at=update, kind="loop", text=f"{_name(pairs)} accepted: {kinds}", pairs=_lists(pairs))
        if refused:
            yield TimelineEvent(at=update, kind="refused", text=f"{_name(refused)} refused", pairs=_lists(refused))


def _rejected(timeline: Timeline) -> Iterator[TimelineEvent]:
    """Hypotheses that RTAB-Map rejected: it keeps no more of them than this statistic."""
    table, snapshot = timeline.statistics, timeline.snapshot
    if snapshot.candidate_rows or not {_REJECTED, _PLACE} <= table.values.keys():
        return
    for row in np.flatnonzero((table.values[_REJECTED] > 0) & (table.values[_PLACE] > 0)).tolist():
        pair = int(table.values[_PLACE][row]), int(table.ids[row])
        if set(pair) <= snapshot.rows.keys():
            yield TimelineEvent(at=pair[1], kind="refused", text=f"{_name([pair])} refused", pairs=_lists([pair]))


def _lost(timeline: Timeline) -> Iterator[TimelineEvent]:
    """One event for the frames that were lost after the same node."""
    first = timeline.ids[0] if timeline.ids else 0
    lost = timeline.snapshot.reader.lost_frames(timeline.snapshot.faults)
    for node_id, frames in groupby(lost, key=lambda one: one.node_id):
        group = list(frames)
        count = "1 frame" if len(group) == 1 else f"{len(group)} frames"
        yield TimelineEvent(at=node_id or first, kind="lost", text=f"{count} lost: {group[0].reason}", pairs=[])


def _moves(timeline: Timeline) -> Iterator[TimelineEvent]:
    """Transfers to long-term memory and retrievals from it."""
    in_ltm: set[int] = set()
    known = timeline.snapshot.rows.keys()
    for move in timeline.moves:
        out = {i for i, tier in move.tiers.items() if tier is Tier.LTM and i in known}
        gone, back = sorted(out - in_ltm), sorted(in_ltm & (move.tiers.keys() - out))
        if gone:
            yield TimelineEvent(at=move.id, kind="transfer", text=f"{_nodes(gone)} to long-term memory", pairs=[])
        if back:
            yield TimelineEvent(at=move.id, kind="retrieval", text=f"{_nodes(back)} back to working memory", pairs=[])
        in_ltm = (in_ltm | out) - set(back)


def _nodes(ids: list[int]) -> str:
    named = ", ".join(str(i) for i in ids[:_NAMED])
    more = f" and {len(ids) - _NAMED} more" if len(ids) > _NAMED else ""
    return f"{'node' if len(ids) == 1 else 'nodes'} {named}{more}"


def _name(pairs: list[Pair]) -> str:
    named = ", ".join(f"{b} → {a}" for a, b in pairs[:_NAMED])
    return named + (f" and {len(pairs) - _NAMED} more" if len(pairs) > _NAMED else "")


def _lists(pairs: list[Pair]) -> list[list[int]]:
    return [[b, a] for a, b in pairs]
