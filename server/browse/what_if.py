"""What another ``Rtabmap/LoopThr`` would mean for a map: at once, from what its updates believed."""

from __future__ import annotations

import threading
from collections import Counter, OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from server.browse.columns import known_poses
from server.browse.loops import evidence
from server.browse.snapshot import Snapshot
from server.schemas import LoopWhatIf, WhatIfGraph, WhatIfLoop
from slam.geometry import Pose, between, rotation_angle, translation_norm
from slam.graph.optimizer import choose_root, optimize
from slam.graph.shift import Shift
from slam.loop.closing import close
from slam.loop.foresight import Foreseen, Hypothesis, Outcome, foresee
from slam.types import Link, Refusal

if TYPE_CHECKING:
    from server.browse.map_view import MapView

_NAMES = ("Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/")
_LOOP_THR = "Rtabmap/LoopThr"
#: Thresholds that a slider may come back to.
_KEPT = 16
#: A loop is true when its transform is this near to the true one.
_TRUE_M = 0.3
_TRUE_RAD = float(np.radians(15.0))
#: Of programs that don't store why.
_SAID = Refusal(
    "run", 0.0, 0.0, "it reached the threshold in the run and did not become a loop; the file does not say why"
)


class WhatIfs:
    """What was foreseen of a map, kept while nothing that it depends on changes: the page and its 3D view ask alike."""

    def __init__(self, view: MapView) -> None:
        self._view = view
        self._lock = threading.Lock()
        self._known: OrderedDict[tuple[float, bool], LoopWhatIf] = OrderedDict()
        self._basis: tuple[int, int] = (0, 0)

    def at(self, threshold: float, *, with_graph: bool) -> LoopWhatIf:
        """The loops at another threshold; those never tried are tried in the background."""
        with self._lock:
            snapshot = self._view.snapshot()
            basis = (snapshot.revision, len(self._view.trials.done(snapshot.params)))
            if basis != self._basis:
                self._basis = basis
                self._known.clear()
            found = self._known.get((threshold, with_graph))
            if found is None or found.pending:
                found = self._known[threshold, with_graph] = _foreseen(self._view, snapshot, threshold, with_graph)
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
            return found


def _foreseen(view: MapView, snapshot: Snapshot, threshold: float, with_graph: bool) -> LoopWhatIf:
    params = snapshot.params
    tried = {**view.trials.done(params), **{p: row.candidate for p, row in snapshot.candidates.items()}}
    held = snapshot.verdicts.keys() & (snapshot.links.keys() | tried.keys())
    found = foresee(_hypotheses(view, snapshot), snapshot.links, tried, held, threshold, params.Rtabmap.LoopThr)
    untried = [one.hypothesis for one in found if one.outcome is Outcome.UNTRIED]
    view.trials.ask(untried, params)
    # Tried or not by now: what is shown does not know it yet.
    pending = len(untried)
    graph, found = _graph(snapshot, found) if with_graph and not pending else (None, found)
    loops = [_loop(snapshot, one) for one in found]
    precision, recall = _scores(loops)
    counts = Counter(loop.outcome.value for loop in loops)
    return LoopWhatIf(
        threshold=threshold,
        in_force=params.Rtabmap.LoopThr,
        loops=loops,
        counts={outcome.value: counts[outcome.value] for outcome in Outcome},
        pending=pending,
        precision=precision,
        recall=recall,
        ate_now_m=snapshot.ate_m if graph is None else snapshot.truth.ate_at(snapshot.optimum, snapshot.links),
        graph=graph,
    )


def _scores(loops: Sequence[WhatIfLoop]) -> tuple[float | None, float | None]:
    """Precision and recall of the loops that would be in the map, among those that have a label."""
    inside = [loop.true for loop in loops if loop.outcome in (Outcome.STAYS, Outcome.COMES)]
    labelled, true = [label for label in inside if label is not None], sum(bool(loop.true) for loop in loops)
    precision = sum(labelled) / len(labelled) if labelled else None
    return precision, sum(labelled) / true if true else None


def _hypotheses(view: MapView, snapshot: Snapshot) -> list[Hypothesis]:
    needed = _needed(snapshot)
    columns = view.statistics.columns(_NAMES, 0)
    places, values = (columns.values[name] for name in _NAMES)
    return [
        Hypothesis(node_id, int(place), value, needed(node_id))
        for node_id, place, value in zip(columns.ids, places, values, strict=True)
        if place is not None and value is not None and place > 0
    ]


def _needed(snapshot: Snapshot) -> Callable[[int], float]:
    """``Rtabmap/LoopThr`` as the update of a node had it: what was set after the last one held for none."""
    sessions = {one.map_id: one for one in snapshot.reader.sessions()}
    changes = [one for one in snapshot.reader.parameter_changes() if one.name == _LOOP_THR]

    def at(node_id: int) -> float:
        row = snapshot.rows.get(node_id)
        session = None if row is None else sessions.get(int(snapshot.nodes.map_ids[row]))
        began = None if session is None else session.started
        text = None if session is None else session.parameters.get(_LOOP_THR)
        for change in changes:
            if change.node_id < node_id and (began is None or change.time >= began):
                text = change.value
        return snapshot.params.Rtabmap.LoopThr if text is None else float(text)

    return at


def _loop(snapshot: Snapshot, one: Foreseen) -> WhatIfLoop:
    from_id, to_id, refusal = one.hypothesis.node_id, one.hypothesis.place_id, None
    if one.outcome is Outcome.REFUSED:
        refusal = _SAID if one.candidate is None else one.candidate.refusal
    return WhatIfLoop(
        key=f"{from_id}-{to_id}",
        from_=from_id,
        to=to_id,
        value=one.hypothesis.value,
        outcome=one.outcome,
        inliers=None if one.candidate is None else evidence(one.candidate.inliers),
        reason="" if refusal is None else refusal.text,
        true=_truth(snapshot, one),
    )


def _truth(snapshot: Snapshot, one: Foreseen) -> bool | None:
    """By a person's decision, else by ground truth; None where neither says."""
    decided = snapshot.verdicts.get(one.hypothesis.pair)
    if decided is not None:
        return decided.action != "reject"
    if one.link is None or one.link.T_from_to is None:
        return None
    T_true = _true_transform(snapshot, one.link)
    if T_true is None:
        return None
    error = between(T_true, one.link.T_from_to)
    return translation_norm(error) < _TRUE_M and rotation_angle(error) < _TRUE_RAD


def _true_transform(snapshot: Snapshot, link: Link) -> Pose | None:
    rows = snapshot.rows
    if link.from_id not in rows or link.to_id not in rows:
        return None
    T_from, T_to = (snapshot.nodes.T_world[rows[i]] for i in (link.from_id, link.to_id))
    return between(T_from, T_to) if np.isfinite(T_from).all() and np.isfinite(T_to).all() else None


def _graph(snapshot: Snapshot, found: Sequence[Foreseen]) -> tuple[WhatIfGraph, list[Foreseen]]:
    """The graph optimised with these loops, beside its optimum as it is; loops that it can't live with are refused."""
    graph, params = snapshot.graph.copy(), snapshot.params
    # Poses of a file need not be at their optimum: what a threshold does is told from the optimum as it is.
    before, judged = snapshot.optimum, list(found)
    graph.poses = dict(before)
    for one in found:
        if one.outcome is Outcome.GOES and one.hypothesis.pair in graph.links:
            graph.remove_link(one.hypothesis.pair)
    coming = [k for k, one in enumerate(found) if one.outcome is Outcome.COMES]
    closed = close(graph, [c for k in coming if (c := found[k].candidate) is not None], params)
    for k, candidate in zip(coming, closed.candidates, strict=True):
        if candidate.refusal is not None:
            judged[k] = replace(found[k], outcome=Outcome.REFUSED, candidate=candidate)
    if not closed.links and len(graph):
        graph.poses = optimize(graph, params, root=choose_root(graph, params, graph.newest)).poses
    shift = Shift.between(before, graph.poses)
    there = known_poses(graph.poses)
    answer = WhatIfGraph(
        ids=list(there),
        poses=list(there.values()),
        moved=shift.moved,
        max_shift_m=shift.max_m,
        ate_m=snapshot.truth.ate_at(graph.poses, graph.links),
        stored_off_m=Shift.between(snapshot.graph.poses, before).max_m,
    )
    return answer, judged
