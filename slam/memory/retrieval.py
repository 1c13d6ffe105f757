"""Which nodes come back from long-term memory: beside the best hypothesis, and around the robot."""

from __future__ import annotations

from slam.graph.graph import PoseGraph
from slam.loop.bayes import neighbours_in_time
from slam.memory.memory import Memory
from slam.memory.places import Places
from slam.params import Params

#: Links walked from the best hypothesis when looking for nodes to bring back.
_REACH = 8


def choose_retrieval(
    memory: Memory, graph: PoseGraph, places: Places, *, node_id: int, best_id: int, params: Params
) -> list[int]:
    """Ids to bring back, at most ``Rtabmap/MaxRetrieved`` by hypothesis and ``RGBD/MaxLocalRetrieved`` by place.

    Args:
        memory: the tiers now.
        graph: optimised poses and links, of all nodes.
        places: where the nodes of long-term memory are.
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
    most = params.RGBD.MaxLocalRetrieved
    around = places.nearest(graph.poses[node_id][:3, 3], most + len(chosen) if most else 0, params.RGBD.LocalRadius)
    return chosen + [i for i in around if i not in chosen][:most]
