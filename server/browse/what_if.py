"""What another ``Rtabmap/LoopThr`` would mean for a map: at once, from what its updates believed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from server.browse.columns import pose_list
from server.browse.loops import evidence
from server.browse.map_view import MapView
from server.browse.snapshot import Snapshot
from server.schemas import LoopWhatIf, WhatIfGraph, WhatIfLoop
from slam.geometry import Pose, between, rotation_angle, translation_norm
from slam.graph.graph import PoseGraph
from slam.graph.optimizer import choose_root, optimize
from slam.graph.shift import Shift
from slam.loop.closing import close
from slam.loop.foresight import Foreseen, Hypothesis, Outcome, foresee
from slam.types import Link, Refusal

_NAMES = ("Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/")
#: A loop is true when its transform is this near to the true one.
_TRUE_M = 0.3
_TRUE_RAD = float(np.radians(15.0))
#: Of programs that don't store why.
_SAID = Refusal(
    "run", 0.0, 0.0, "it reached the threshold in the run and did not become a loop; the file does not say why"
)


def loop_what_if(view: MapView, threshold: float, *, with_graph: bool) -> LoopWhatIf:
    """The loops at another threshold; those never tried are tried in the background."""
    snapshot, params = view.snapshot(), view.snapshot().params
    tried = {**view.trials.done(params), **{p: row.candidate for p, row in snapshot.candidates.items()}}
    held = {pair for pair in snapshot.links.keys() | tried.keys() if snapshot.history.last(pair) is not None}
    found = foresee(_hypotheses(view), snapshot.links, tried, held, threshold, params.Rtabmap.LoopThr)
    pending = view.trials.ask([one.hypothesis for one in found if one.outcome is Outcome.UNTRIED], params)
    graph, found = _graph(snapshot, found) if with_graph and not pending else (None, found)
    loops = [_loop(snapshot, one) for one in found]
    inside = [loop for loop in loops if loop.outcome in (Outcome.STAYS, Outcome.COMES)]
    known = [loop for loop in loops if loop.true]
    labelled = [loop for loop in inside if loop.true is not None]
    counts = Counter(loop.outcome.value for loop in loops)
    return LoopWhatIf(
        threshold=threshold,
        in_force=params.Rtabmap.LoopThr,
        loops=loops,
        counts={outcome.value: counts[outcome.value] for outcome in Outcome},
        pending=pending,
        precision=sum(bool(loop.true) for loop in labelled) / len(labelled) if labelled else None,
        recall=sum(loop in inside for loop in known) / len(known) if known else None,
        graph=graph,
    )


def _hypotheses(view: MapView) -> list[Hypothesis]:
    columns = view.statistics.columns(_NAMES, 0)
    places, values = (columns.values[name] for name in _NAMES)
    return [
        Hypothesis(node_id, int(place), value)
        for node_id, place, value in zip(columns.ids, places, values, strict=True)
        if place is not None and value is not None and place > 0
    ]


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
    decided = snapshot.history.last(one.hypothesis.pair)
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
    """The graph optimised with these loops, from the poses as they are; loops that it can't live with are refused."""
    graph, params = PoseGraph.from_reader(snapshot.reader), snapshot.params
    before, judged = graph.poses, list(found)
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
    there = {i: pose for i, T in graph.poses.items() if (pose := pose_list(T)) is not None}
    answer = WhatIfGraph(
        ids=list(there),
        poses=list(there.values()),
        moved=shift.moved,
        max_shift_m=shift.max_m,
        ate_m=snapshot.ate_at(graph.poses, graph.links),
    )
    return answer, judged
