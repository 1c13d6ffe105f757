"""What came of a trial, as the page has it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from server.browse.columns import known_poses, number, number_list
from server.schemas import TrialComparison, TrialLoop, TrialSide
from slam.database import MapReader
from slam.graph.graph import Pair
from slam.tools.outcome import Outcome
from slam.tools.trial import Comparison
from slam.types import Link


def trial_comparison(reader: MapReader, found: Comparison) -> TrialComparison:
    """Both sides; ``reader`` is of the map that was tried."""
    known = {_pair(row.candidate.from_id, row.candidate.to_id) for row in reader.candidates()}
    known |= found.original.loops.keys()
    return TrialComparison(
        original=_side(found.original),
        baseline=_side(found.baseline),
        tried=_side(found.tried),
        came=_loops(found.came, found.tried.loops, known),
        gone=_loops(found.gone, found.baseline.loops, known),
        unlike=found.unlike,
        drift_m=found.drift_m,
        moved=found.shift.moved,
        max_shift_m=found.shift.max_m,
        images=found.images,
    )


def _side(one: Outcome) -> TrialSide:
    times, wm = (values[np.isfinite(values)] for values in (one.update_ms, one.wm))
    poses = known_poses(one.poses)
    return TrialSide(
        nodes=one.nodes,
        sessions=one.sessions,
        loops=dict(sorted(one.loop_counts.items())),
        loops_total=len(one.loops),
        refused=len(one.refusals),
        ate_m=number(one.ate_m),
        path_m=one.path_m,
        median_ms=float(np.median(times)) if len(times) else None,
        p95_ms=float(np.percentile(times, 95)) if len(times) else None,
        max_ms=float(times.max()) if len(times) else None,
        wm_max=int(wm.max()) if len(wm) else None,
        stm_max=one.stm_max,
        ltm_end=one.ltm_end,
        retrieved=one.retrieved,
        transferred=one.transferred,
        update_ids=one.ids.tolist(),
        update_ms=number_list(one.update_ms, 3),
        wm=number_list(one.wm, 0),
        ids=list(poses),
        poses=list(poses.values()),
        loop_pairs=[list(pair) for pair in sorted(one.loops)],
    )


def _loops(reasons: Mapping[Pair, str], links: Mapping[Pair, Link], known: set[Pair]) -> list[TrialLoop]:
    return [
        TrialLoop(key=f"{pair[1]}-{pair[0]}", type=links[pair].type.label, reason=reason, known=pair in known)
        for pair, reason in reasons.items()
    ]


def _pair(a: int, b: int) -> Pair:
    return min(a, b), max(a, b)
