"""The review queue: every loop that is in the graph, was refused, or was decided about."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from server.browse.columns import number
from server.browse.snapshot import Pair, Snapshot
from server.schemas import LoopDoubt, LoopReason, LoopRival, LoopRow, Loops
from slam.database import LoopState
from slam.geometry import translation_norm
from slam.types import Candidate, Link, LinkType, Refusal

_DECIDED = {"approve": LoopState.APPROVED, "reject": LoopState.REJECTED, "add": LoopState.ADDED}


def loops(snapshot: Snapshot, after: int = 0) -> Loops:
    """Every loop whose update came after node ``after``; the newest first."""
    rows = [row for row in _rows(snapshot) if row.update > after]
    counts = Counter(row.state.value for row in rows)
    return Loops(loops=rows, counts={state.value: counts[state.value] for state in LoopState})


def loop_state(snapshot: Snapshot, pair: Pair) -> LoopState | None:
    """Where a loop stands; None for odometry, for what was never looked at, and for nodes that are gone."""
    link = snapshot.links.get(pair)
    decided = snapshot.verdicts.get(pair)
    if decided is not None:
        return _DECIDED[decided.action]
    if link is not None:
        return LoopState.ACCEPTED if link.type.is_loop else None
    looked_at = snapshot.candidates.get(pair)
    # A node that became part of an older one (Mem/ReduceGraph) has no loops that could be decided about.
    if looked_at is None or not set(pair) <= snapshot.rows.keys():
        return None
    return None if taken_back(looked_at.candidate) else LoopState.REFUSED


def taken_back(candidate: Candidate) -> bool:
    """Whether a pair that is not in the graph was found by a search for more loops, which somebody undid."""
    return candidate.type is LinkType.USER_CLOSURE and candidate.refusal is None


def reason(refusal: Refusal | None) -> LoopReason | None:
    """Why a loop was refused, as the page gets it."""
    if refusal is None:
        return None
    return LoopReason(
        test=refusal.test, value=number(refusal.value), threshold=number(refusal.threshold), text=refusal.text
    )


def doubt(snapshot: Snapshot, pair: Pair) -> LoopDoubt | None:
    """What speaks against a loop; None where there is no transform to judge."""
    found = snapshot.suspicions.get(pair)
    if found is None:
        return None
    return LoopDoubt(
        score=found.score,
        residual=number(found.residual),
        odometry=number(found.odometry),
        neighbors=number(found.neighbors),
        compared=found.compared,
        agreeing=found.agreeing,
    )


def rival(snapshot: Snapshot, pair: Pair) -> LoopRival | None:
    """The place elsewhere that rivals the one which a loop leads to, as the page gets it."""
    found = snapshot.look_alike(pair)
    if found is None:
        return None
    return LoopRival(node=found.node_id, distance_m=found.distance_m, share=found.share)


def evidence(count: int) -> int | None:
    """A number of matches or inliers; None when it was refused before they were counted."""
    return count if count >= 0 else None


def _rows(snapshot: Snapshot) -> Iterator[LoopRow]:
    in_graph = {pair for pair, link in snapshot.links.items() if link.type.is_loop}
    decided = {entry.pair for entry in snapshot.journal}
    for pair in sorted(in_graph | decided | snapshot.candidates.keys(), key=lambda p: (-p[1], -p[0])):
        state = loop_state(snapshot, pair)
        if state is not None:
            yield _row(snapshot, pair, state)


def _row(snapshot: Snapshot, pair: Pair, state: LoopState) -> LoopRow:
    link, recorded, candidate = snapshot.links.get(pair), snapshot.candidates.get(pair), snapshot.looked_at(pair)
    T_from_to = link.T_from_to if link is not None else candidate.T_from_to if candidate is not None else None
    from_id, to_id = _direction(pair, link, candidate)
    return LoopRow(
        key=f"{from_id}-{to_id}",
        from_=from_id,
        to=to_id,
        type=_type(link, candidate).label,
        state=state,
        posterior=None if candidate is None else number(candidate.posterior),
        inliers=None if candidate is None else evidence(candidate.inliers),
        matches=None if candidate is None else evidence(candidate.matches),
        residual_sigma=number(snapshot.residuals.get(pair)),
        doubt=doubt(snapshot, pair),
        translation_m=None if T_from_to is None else translation_norm(T_from_to),
        graph_distance=_graph_distance(snapshot, pair),
        sessions=[_session(snapshot, node_id) for node_id in (from_id, to_id)],
        look_alike=rival(snapshot, pair),
        update=pair[1] if recorded is None else recorded.update_id,
        reason=None if candidate is None else reason(candidate.refusal),
    )


def _graph_distance(snapshot: Snapshot, pair: Pair) -> int:
    """Ends that are no nodes of the map any more count by their ids."""
    a, b = (snapshot.rows.get(node_id) for node_id in pair)
    return abs(pair[1] - pair[0]) if a is None or b is None else abs(b - a)


def _session(snapshot: Snapshot, node_id: int) -> int:
    row = snapshot.rows.get(node_id)
    return -1 if row is None else int(snapshot.nodes.map_ids[row])


def _direction(pair: Pair, link: Link | None, candidate: Candidate | None) -> Pair:
    if link is not None:
        return link.from_id, link.to_id
    if candidate is not None:
        return candidate.from_id, candidate.to_id
    return pair[1], pair[0]


def _type(link: Link | None, candidate: Candidate | None) -> LinkType:
    if link is not None:
        return link.type
    return LinkType.USER_CLOSURE if candidate is None else candidate.type
