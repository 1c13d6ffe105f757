"""Which nodes come back from long-term memory: beside the best hypothesis, and around the robot."""

from __future__ import annotations

import numpy as np

from slam.graph.graph import PoseGraph
from slam.loop.bayes import neighbours_in_time
from slam.memory.memory import Memory
from slam.params import Params

#: Links walked from the best hypothesis when looking for nodes to bring back.
_REACH = 8


def choose_retrieval(memory: Memory, graph: PoseGraph, *, node_id: int, best_id: int, params: Params) -> list[int]:
    """Ids to bring back, at most ``Rtabmap/MaxRetrieved`` by hypothesis and ``RGBD/MaxLocalRetrieved`` by place.

    Args:
        memory: the tiers now.
        graph: optimised poses and links.
        node_id: the new node.
        best_id: the best loop hypothesis, 0 when none passed ``Rtabmap/LoopThr``.
        params: the two limits and ``RGBD/LocalRadius`` are read.
    """
    chosen: list[int] = []
    if best_id:
        near_in_time = neighbours_in_time(best_id, graph, _REACH) & memory.ltm
        near = [i for i in graph.within(best_id, _REACH) if i in memory.ltm]
        ordered = [*(i for i in near if i in near_in_time), *(i for i in near if i not in near_in_time)]
        chosen = ordered[: params.Rtabmap.MaxRetrieved]
    return chosen + _around(memory, graph, node_id, set(chosen), params)


def _around(memory: Memory, graph: PoseGraph, node_id: int, chosen: set[int], params: Params) -> list[int]:
    ids = sorted(memory.ltm - chosen)
    if not ids or params.RGBD.MaxLocalRetrieved == 0:
        return []
    here = graph.poses[node_id][:3, 3]
    distances = np.linalg.norm(np.array([graph.poses[i][:3, 3] for i in ids]) - here, axis=1)
    order = np.argsort(distances, kind="stable")[: params.RGBD.MaxLocalRetrieved]
    return [ids[k] for k in order if distances[k] <= params.RGBD.LocalRadius]
