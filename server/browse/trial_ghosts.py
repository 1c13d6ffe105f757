"""What a map would be by a trial, in the shape in which the 3D view draws what would be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from server.schemas import LoopWhatIf, TrialComparison, TrialLoop, WhatIfGraph, WhatIfLoop
from slam.loop.foresight import Outcome


def ghosts_of(found: TrialComparison) -> LoopWhatIf:
    """Loops that come and go between both replays, and the path of the one with the changes."""
    loops = [*_loops(found.came, Outcome.COMES), *_loops(found.gone, Outcome.GOES)]
    graph = WhatIfGraph(
        ids=found.tried.ids,
        poses=found.tried.poses,
        moved=found.moved,
        max_shift_m=found.max_shift_m,
        ate_m=found.tried.ate_m,
        stored_off_m=0.0,
    )
    return LoopWhatIf(
        threshold=0.0,
        in_force=0.0,
        loops=loops,
        counts={Outcome.COMES: len(found.came), Outcome.GOES: len(found.gone)},
        pending=0,
        precision=None,
        recall=None,
        ate_now_m=found.original.ate_m,
        graph=graph,
    )


def _loops(found: Sequence[TrialLoop], outcome: Outcome) -> Iterator[WhatIfLoop]:
    for loop in found:
        newer, older = (int(number) for number in loop.key.split("-"))
        yield WhatIfLoop(
            key=loop.key,
            from_=newer,
            to=older,
            value=0.0,
            outcome=outcome,
            inliers=None,
            reason=loop.reason,
            true=None,
        )
