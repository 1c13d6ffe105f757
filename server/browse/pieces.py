"""What hangs together in a map's graph, and why the rest does not."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from server.browse.columns import number
from server.browse.loops import evidence, reason
from server.browse.map_view import MapView
from server.browse.snapshot import Snapshot
from server.schemas import BestGuess, Component, Components, NearMiss
from slam.database import CandidateRow
from slam.graph.components import components
from slam.types import LinkType

_NAMES = ("Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/")
#: Components that are listed, and refused loops of each.
_MOST, _BEST = 100, 5


def component_list(view: MapView) -> Components:
    """Each component with the best loops that were refused between it and the others."""
    snapshot = view.snapshot()
    piece_of = pieces(snapshot)
    members: defaultdict[int, list[int]] = defaultdict(list)
    for node_id, piece in piece_of.items():
        members[piece].append(node_id)
    order = sorted(members, key=lambda piece: (-len(members[piece]), piece))[:_MOST]
    refused = _refused_between(snapshot, piece_of) if len(members) > 1 else {}
    guesses = _guesses(view, snapshot, piece_of) if len(members) > 1 else {}
    found = [_component(snapshot, piece_of, members[piece], refused.get(piece, [])) for piece in order]
    told = [one if one.tried else one.model_copy(update={"guess": guesses.get(one.id)}) for one in found]
    return Components(components=told, count=len(members))


def pieces(snapshot: Snapshot) -> dict[int, int]:
    """Node id -> oldest node of its component; landmarks that both sides saw join like links."""
    graph = snapshot.graph
    sightings = [(a, b) for (a, b, kind) in graph.constraints if kind is LinkType.LANDMARK]
    if snapshot.params.Optimizer.LandmarksIgnored:
        sightings = []
    roots = components(
        {*graph.poses.keys() & snapshot.rows.keys(), *(b for _, b in sightings)}, (*graph.links, *sightings)
    )
    oldest: dict[int, int] = {}
    for node_id in sorted(i for i in roots if i > 0):
        oldest.setdefault(roots[node_id], node_id)
    return {i: oldest[root] for i, root in roots.items() if i > 0}


def _component(snapshot: Snapshot, piece_of: dict[int, int], ids: list[int], refused: list[CandidateRow]) -> Component:
    sessions = sorted({int(snapshot.nodes.map_ids[snapshot.rows[i]]) for i in ids})
    best = sorted(refused, key=_nearness, reverse=True)[:_BEST]
    return Component(
        id=min(ids),
        nodes=len(ids),
        newest=max(ids),
        sessions=sessions,
        tried=len(refused),
        near_misses=[_near_miss(row, piece_of, min(ids)) for row in best],
        guess=None,
    )


def _nearness(row: CandidateRow) -> tuple[float, float]:
    """How near a refused loop came: by inliers, among equals by the belief."""
    candidate = row.candidate
    return float(candidate.inliers), float(np.nan_to_num(candidate.posterior))


def _near_miss(row: CandidateRow, piece_of: dict[int, int], piece: int) -> NearMiss:
    candidate = row.candidate
    ends = {piece_of[candidate.from_id], piece_of[candidate.to_id]}
    return NearMiss(
        from_=candidate.from_id,
        to=candidate.to_id,
        type=candidate.type.label,
        component=next(iter(ends - {piece})),
        posterior=number(candidate.posterior),
        matches=evidence(candidate.matches),
        inliers=evidence(candidate.inliers),
        reason=reason(candidate.refusal),
        removed=candidate.refusal is None,
    )


def _refused_between(snapshot: Snapshot, piece_of: dict[int, int]) -> dict[int, list[CandidateRow]]:
    found: defaultdict[int, list[CandidateRow]] = defaultdict(list)
    for (a, b), row in snapshot.candidates.items():
        if a in piece_of and b in piece_of and piece_of[a] != piece_of[b]:
            found[piece_of[a]].append(row)
            found[piece_of[b]].append(row)
    return found


def _guesses(view: MapView, snapshot: Snapshot, piece_of: dict[int, int]) -> dict[int, BestGuess]:
    """The strongest hypothesis across the border of each component, whichever side the robot was on."""
    columns = view.statistics.columns(_NAMES, 0)
    found: dict[int, BestGuess] = {}
    for node_id, place, value in zip(columns.ids, *(columns.values[name] for name in _NAMES), strict=True):
        if place is None or value is None or node_id not in piece_of or int(place) not in piece_of:
            continue
        ends = piece_of[node_id], piece_of[int(place)]
        guess = BestGuess(node=node_id, place=int(place), value=value, threshold=snapshot.params.Rtabmap.LoopThr)
        for end in ends if ends[0] != ends[1] else ():
            if end not in found or value > found[end].value:
                found[end] = guess
    return found
