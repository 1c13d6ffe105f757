"""Which nodes of working memory may not leave it, and for which reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slam.graph.graph import PoseGraph
from slam.loop.bayes import neighbours_in_time
from slam.memory.memory import Memory
from slam.params import Params


@dataclass(frozen=True, slots=True)
class Immunity:
    """Ids in working memory that stay.

    Attributes:
        globally: neighbours in time of the best hypothesis.
        locally: on the way from the nearest node to the robot's, and the closest ones.
        most_locally: as many of those there may be (``RGBD/LocalImmunizationRatio`` of working memory).
        lately: linked to STM, the last loop's node, and the newest share after it (``Mem/RecentWmRatio``).
    """

    globally: frozenset[int] = frozenset()
    locally: frozenset[int] = frozenset()
    most_locally: int = 0
    lately: frozenset[int] = frozenset()

    @property
    def ids(self) -> frozenset[int]:
        """All of them."""
        return self.globally | self.locally | self.lately

    @classmethod
    def of(
        cls, memory: Memory, graph: PoseGraph, active: PoseGraph, best_id: int, last_loop_id: int, params: Params
    ) -> Immunity:
        """What must stay now.

        Args:
            memory: the tiers.
            graph: all nodes.
            active: nodes in RAM, joined over what is not, where the way to the robot is looked for.
            best_id: the best loop hypothesis, 0 for none.
            last_loop_id: the old node of the last loop closure, 0 for none.
            params: the ratios and ``RGBD/LocalRadius`` are read.
        """
        beside: set[int] = set()
        if best_id in memory.wm:
            beside = neighbours_in_time(best_id, graph, params.Rtabmap.MaxRetrieved + 1)
        most = int(params.RGBD.LocalImmunizationRatio * len(memory.wm))
        return cls(
            globally=frozenset(beside & memory.wm.keys()),
            locally=frozenset(_local(memory, graph, active, params, most)),
            most_locally=most,
            lately=frozenset(_late(memory, graph, last_loop_id, params)),
        )


def _late(memory: Memory, graph: PoseGraph, last_loop_id: int, params: Params) -> set[int]:
    kept = {other for i in memory.stm for other, _ in graph.places_beside(i) if other in memory.wm}
    kept |= {last_loop_id} & memory.wm.keys()
    recent = sorted(i for i in memory.wm if i > last_loop_id)
    share = int(params.Mem.RecentWmRatio * len(memory.wm))
    kept.update(recent[-share:] if share else [])
    return kept


def _local(memory: Memory, graph: PoseGraph, active: PoseGraph, params: Params, most: int) -> list[int]:
    """At most so many: first those on the way from the nearest node, then the closest ones."""
    if not most or not memory.stm:
        return []
    closest = _closest(memory, graph, params)
    way = active.way(closest[0], memory.stm[-1]) if closest else []
    return list(dict.fromkeys([*(i for i in way if i in memory.wm), *closest]))[:most]


def _closest(memory: Memory, graph: PoseGraph, params: Params) -> list[int]:
    """Ids within ``RGBD/LocalRadius`` of the robot, the nearest first and the smaller id of two as near."""
    here = graph.poses[memory.stm[-1]][:3, 3]
    ids = sorted(memory.wm)
    distances = np.linalg.norm(np.array([graph.poses[i][:3, 3] for i in ids]) - here, axis=1)
    return [ids[k] for k in np.argsort(distances, kind="stable") if distances[k] <= params.RGBD.LocalRadius]
