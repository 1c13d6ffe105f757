"""Which nodes changed memory at which update, from the first on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.database import Faults, MapReader, StatisticsTable, UpdateRow
from slam.geometry import Pose
from slam.types import Tier

_STM = "Memory/Short_time_memory_size/"
#: States of working memory in RAM at a time; each has the ids of all its nodes.
_AT_ONCE = 200


@dataclass(frozen=True, slots=True, eq=False)
class Move:
    """What one update did to the memories.

    Attributes:
        id: the node of the update.
        tiers: id -> tier of the nodes whose tier changed.
        T_map_base: pose of the node in the map as it was then; None when that is not known.
    """

    id: int
    tiers: Mapping[int, Tier]
    T_map_base: Pose | None = None


def recorded_moves(updates: Iterable[UpdateRow]) -> list[Move]:
    """The moves that slamdeck records with each update."""
    return [Move(row.id, row.tiers, row.T_map_base) for row in updates]


def moves_of_states(
    reader: MapReader, statistics: StatisticsTable, before: int | None, faults: Faults
) -> Iterator[Move]:
    """The moves between the states of working memory that RTAB-Map keeps (``Rtabmap/SaveWMState``).

    A state lists short-term and working memory together; as many of its newest nodes as the statistic says are in
    short-term memory.

    Args:
        reader: of the map.
        statistics: of its updates, with the size of short-term memory.
        before: only updates before this node; None for all.
        faults: where rows go that make no sense.
    """
    stm_sizes = dict(zip(statistics.ids.tolist(), _sizes(statistics), strict=True))
    known: dict[int, Tier] = {}
    last = 0
    while states := reader.wm_states(after=last, most=_AT_ONCE, faults=faults):
        for update_id, ids in states.items():
            if before is not None and update_id >= before:
                return
            now = _tiers(ids, stm_sizes.get(update_id, 0))
            changed = {i: tier for i, tier in now.items() if known.get(i) is not tier}
            yield Move(update_id, changed | dict.fromkeys(known.keys() - now.keys(), Tier.LTM))
            known = now
        last = max(states)


def _sizes(statistics: StatisticsTable) -> list[int]:
    sizes = statistics.values.get(_STM, np.zeros(len(statistics.ids)))
    return [int(size) for size in np.nan_to_num(sizes)]


def _tiers(ids: NDArray[np.int32], stm: int) -> dict[int, Tier]:
    ordered: list[int] = np.sort(ids).tolist()
    middle = len(ordered) - stm
    return dict.fromkeys(ordered[:middle], Tier.WM) | dict.fromkeys(ordered[middle:], Tier.STM)
