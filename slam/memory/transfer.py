"""Which nodes leave working memory when there is too little time or room, and which may not."""

from __future__ import annotations

import numpy as np

from slam.graph.graph import PoseGraph
from slam.loop.bayes import neighbours_in_time
from slam.memory.memory import Memory
from slam.params import Params


def choose_transfer(
    memory: Memory,
    graph: PoseGraph,
    *,
    retrieved: list[int],
    elapsed_ms: float,
    best_id: int,
    last_loop_id: int,
    params: Params,
) -> list[int]:
    """Ids to move to long-term memory: lightest first, then longest in working memory.

    Args:
        memory: the tiers now.
        graph: optimised poses and links.
        retrieved: nodes that came back in this update; they stay, and as many others and two more may go.
        elapsed_ms: what the update took so far.
        best_id: the best loop hypothesis, 0 for none.
        last_loop_id: the old node of the last loop closure, 0 for none.
        params: TimeThr, MemoryThr and the immunisation ratios are read.
    """
    over_time = 0 < params.Rtabmap.TimeThr < elapsed_ms
    over_room = 0 < params.Rtabmap.MemoryThr < len(memory.wm)
    if not (over_time or over_room):
        return []
    kept = immunized(memory, graph, best_id, last_loop_id, params) | set(retrieved)
    free = [node_id for node_id in memory.wm if node_id not in kept]
    if params.Mem.TransferSortingByWeightId:
        free.sort(key=lambda i: (memory.weights[i], i))
    else:
        free.sort(key=lambda i: (memory.weights[i], memory.wm[i], i))
    return free[: len(retrieved) + 2]


def immunized(memory: Memory, graph: PoseGraph, best_id: int, last_loop_id: int, params: Params) -> set[int]:
    """Nodes of working memory that must stay.

    Those linked to STM, the last loop's node, the newest share after it (``Mem/RecentWmRatio``), the neighbours in
    time of the best hypothesis, and the closest ones (``RGBD/LocalImmunizationRatio`` of working memory).
    """
    kept = {other for i in memory.stm for other in graph.neighbors(i) if other in memory.wm}
    kept |= {last_loop_id} & memory.wm.keys()
    recent = sorted(i for i in memory.wm if i > last_loop_id)
    share = int(params.Mem.RecentWmRatio * len(memory.wm))
    kept.update(recent[-share:] if share else [])
    if best_id in memory.wm:
        kept |= neighbours_in_time(best_id, graph, params.Rtabmap.MaxRetrieved + 1) & memory.wm.keys()
    return kept | set(_closest(memory, graph, params))


def _closest(memory: Memory, graph: PoseGraph, params: Params) -> list[int]:
    count = int(params.RGBD.LocalImmunizationRatio * len(memory.wm))
    if not count or not memory.stm:
        return []
    here = graph.poses[memory.stm[-1]][:3, 3]
    ids = sorted(memory.wm)
    distances = np.linalg.norm(np.array([graph.poses[i][:3, 3] for i in ids]) - here, axis=1)
    order = np.argsort(distances, kind="stable")[:count]
    return [ids[k] for k in order if distances[k] <= params.RGBD.LocalRadius]
