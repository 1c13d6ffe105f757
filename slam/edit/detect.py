"""Detect more loop closures: nodes that the optimised poses put close together are registered (as RTAB-Map does)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.database import JournalEntry
from slam.edit.choice import require_session
from slam.edit.job import Job, JobStep
from slam.edit.matching import information_of, matched
from slam.edit.scratch import scratch
from slam.edit.views import StoredViews
from slam.edit.wishes import Detection, Matching
from slam.errors import DatabaseError, DecisionError
from slam.graph.components import components
from slam.graph.graph import Pair, PoseGraph
from slam.loop.closing import close
from slam.params import Params
from slam.review import Review
from slam.types import Candidate, LinkType, Refusal


def detect_more(review: Review, views: StoredViews, wanted: Detection, author: str = "") -> Job:
    """Find loops and add them as one batch, which one undo takes back; every pair tried is kept as a candidate.

    In each round a node takes part in one found loop at most. Every found link goes through the optimisation and
    ``RGBD/OptimizeMaxError`` before the next is tried; the map itself changes at the end, in one transaction.

    Raises:
        DecisionError: neither kind of pair is wanted, or the batch does not fit the graph.
        DatabaseError: it can't be written.
    """
    _check(review.graph, wanted)
    graph, found, tried = scratch(review.graph), list[Candidate](), dict[Pair, Candidate]()
    for number in range(wanted.iterations):
        pairs = [pair for pair in close_pairs(graph, wanted) if pair not in tried]
        yield JobStep(number / wanted.iterations, f"round {number + 1}: {len(pairs)} pairs of nodes are close")
        before = len(found)
        for share, candidate in _round(graph, review, views, wanted, pairs):
            tried[candidate.to_id, candidate.from_id] = tried[candidate.from_id, candidate.to_id] = candidate
            found += [candidate] if candidate.refusal is None else []
            yield JobStep((number + share) / wanted.iterations, _told(candidate))
        if len(found) == before:
            break
    looked_at = [candidate for pair, candidate in tried.items() if pair[0] > pair[1]]
    yield JobStep(1.0, f"{len(found)} loops found, {len(looked_at)} pairs tried")
    if found:
        return review.change([_entry(candidate, author) for candidate in found], candidates=looked_at)
    if looked_at:
        review.keep(looked_at)
    return None


def _check(graph: PoseGraph, wanted: Detection) -> None:
    if not (wanted.intra or wanted.inter):
        raise DecisionError("no pair would be looked at: ask for those of one session, of two sessions, or both")
    if wanted.min_radius_m > wanted.radius_m:
        raise DecisionError(
            f"no pair would be looked at: the smallest distance, {wanted.min_radius_m:g} m, is more than the largest,"
            f" {wanted.radius_m:g} m"
        )
    require_session(graph, wanted.session)


def close_pairs(graph: PoseGraph, wanted: Detection) -> Iterator[Pair]:
    """Pairs (newer, older) of nodes that may be looked at, the newest first and of each the nearest first."""
    ids = np.array(sorted(graph.poses), np.int64)
    T = np.array([graph.poses[i] for i in ids.tolist()]).reshape(-1, 4, 4)
    positions, forward = T[:, :3, 3], T[:, :3, 0]
    sessions, piece = np.array([graph.map_ids[i] for i in ids.tolist()]), _pieces(graph, ids.tolist())
    least = np.cos(np.radians(wanted.angle_deg))
    for row in range(len(ids) - 1, 0, -1):
        distance = np.linalg.norm(positions[:row] - positions[row], axis=1)
        chosen = (distance <= wanted.radius_m) & (distance >= wanted.min_radius_m)
        # Poses of graphs that nothing joins say nothing about each other.
        chosen &= (forward[:row] @ forward[row] >= least) & (piece[:row] == piece[row])
        same = sessions[:row] == sessions[row]
        chosen &= (same & wanted.intra) | (~same & wanted.inter)
        if wanted.session >= 0:
            chosen &= (sessions[:row] == wanted.session) | (sessions[row] == wanted.session)
        if not chosen.any():
            continue
        new = int(ids[row])
        near = graph.within(new, max(0, wanted.min_graph_distance - 1))
        linked = graph.neighbors(new)
        for other in np.flatnonzero(chosen)[np.argsort(distance[chosen], kind="stable")].tolist():
            old = int(ids[other])
            if old not in linked and not (same[other] and old in near):
                yield new, old


def _pieces(graph: PoseGraph, ids: Sequence[int]) -> NDArray[np.int64]:
    """(N,) which nodes are joined."""
    first = components(ids, graph.links)
    return np.array([first[i] for i in ids], np.int64)


def _round(
    graph: PoseGraph, review: Review, views: StoredViews, wanted: Detection, pairs: Sequence[Pair]
) -> Iterator[tuple[float, Candidate]]:
    """Every pair that is tried with its verdict, and the share of the round that is done then."""
    used: set[int] = set()
    for k, (new, old) in enumerate(pairs):
        if new in used or old in used:
            continue
        candidate = _tried(graph, review.params, views, wanted, new, old)
        candidate = close(graph, [candidate], review.params).candidates[0]
        if candidate.refusal is None:
            used |= {new, old}
        yield (k + 1) / len(pairs), candidate


def _tried(graph: PoseGraph, params: Params, views: StoredViews, wanted: Detection, new: int, old: int) -> Candidate:
    nothing = Candidate(new, old, LinkType.USER_CLOSURE, float("nan"), -1, -1, None, None, None)
    try:
        found = matched(views, graph, new, old, Matching(wanted.method, wanted.guess), params)
    except (DecisionError, DatabaseError) as error:
        return replace(nothing, refusal=Refusal("stored data", 0.0, 1.0, str(error)))
    icp = found.icp if wanted.method == "icp" else None
    return replace(
        nothing,
        matches=len(found.matches) if icp is None else icp.points,
        inliers=int(found.inliers.sum()) if icp is None else round(icp.ratio * icp.points),
        T_from_to=found.T_from_to,
        information=None if found.T_from_to is None else information_of(found),
        refusal=found.refusal,
        by_scans=wanted.method == "icp",
    )


def _told(candidate: Candidate) -> str:
    pair = f"{candidate.from_id}-{candidate.to_id}"
    if candidate.refusal is not None:
        return f"{pair}: {candidate.refusal.text}"
    return f"{pair}: found, {candidate.inliers} of {candidate.matches} agree"


def _entry(candidate: Candidate, author: str) -> JournalEntry:
    return JournalEntry(
        action="add",
        from_id=candidate.from_id,
        to_id=candidate.to_id,
        author=author,
        link_after=candidate.link,
        note=f"detected: {candidate.inliers} of {candidate.matches} agree",
    )
