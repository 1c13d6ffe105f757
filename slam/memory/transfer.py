"""Which nodes leave working memory when there is too little time or room."""

from __future__ import annotations

from collections.abc import Collection

from slam.memory.memory import Memory
from slam.params import Params


def is_bounded(params: Params) -> bool:
    """Whether any node ever leaves."""
    return params.Rtabmap.TimeThr > 0 or params.Rtabmap.MemoryThr > 0


def choose_transfer(
    memory: Memory, *, immune: Collection[int], retrieved: Collection[int], elapsed_ms: float, params: Params
) -> list[int]:
    """Ids to move to long-term memory: lightest first, then longest in working memory.

    Args:
        memory: the tiers now.
        immune: nodes that may not leave.
        retrieved: nodes that came back in this update; they stay, and as many others and two more may go.
        elapsed_ms: what the update took so far.
        params: TimeThr and MemoryThr are read.
    """
    over_time = 0 < params.Rtabmap.TimeThr < elapsed_ms
    over_room = 0 < params.Rtabmap.MemoryThr < len(memory.wm)
    if not (over_time or over_room):
        return []
    kept = {*immune, *retrieved}
    free = [node_id for node_id in memory.wm if node_id not in kept]
    if params.Mem.TransferSortingByWeightId:
        free.sort(key=lambda i: (memory.weights[i], i))
    else:
        free.sort(key=lambda i: (memory.weights[i], memory.wm[i], i))
    return free[: len(retrieved) + 2]
