"""The updates of a map in their order, and what the map was after each of them."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from server.browse.moves import Move
from server.browse.snapshot import Pair, Snapshot
from slam.database import StatisticsTable
from slam.geometry import Pose
from slam.types import Link, LinkType, Tier

_BELIEF = ("Loop/Highest_hypothesis_id/", "Loop/Highest_hypothesis_value/")


@dataclass(frozen=True, slots=True)
class Verdict:
    """What an update said of a pair of nodes: the loop's type, and whether it was put into the graph."""

    update: int
    pair: Pair
    type: LinkType
    accepted: bool


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What a map was after one of its updates.

    Attributes:
        at: the node of the update; nodes after it did not exist.
        tiers: id -> tier of the nodes, as far as the file records it.
        loops: type of each loop that was in the graph.
        refused: pairs that had been looked at and were no loops.
        best_id: the most probable place, 0 for none.
        value: its hypothesis value, NaN where unknown.
        T_map_base: where the robot was thought to be; None when that is not known.
    """

    at: int
    tiers: Mapping[int, Tier]
    loops: Mapping[Pair, LinkType]
    refused: tuple[Pair, ...]
    best_id: int
    value: float
    T_map_base: Pose | None


class Timeline:
    """The history of one snapshot.

    People's decisions about loops are not part of it: the file says when they were made by the clock on the wall, not
    between which updates. They show in the map as it is now.

    Attributes:
        snapshot: the map as it is now.
        ids: (U,) nodes of the updates, ascending.
        stamps: (U,) seconds.
        moves: of nodes between memories, by update.
        verdicts: about loops, by update.
    """

    def __init__(self, snapshot: Snapshot, moves: Sequence[Move], statistics: StatisticsTable) -> None:
        self.snapshot = snapshot
        self.moves = _turned(snapshot, moves)
        self.statistics = statistics
        self.verdicts = sorted(_verdicts(snapshot), key=lambda one: one.update)
        self.ids, self.stamps = self._updates()

    @property
    def knows_memory(self) -> bool:
        """Whether the file records which node was in which memory."""
        return bool(self.moves)

    @cached_property
    def links_before(self) -> Mapping[Pair, Link | None]:
        """The links as they were before anybody decided about one; None for pairs that had none."""
        return _before_decisions(self.snapshot)

    @cached_property
    def turns(self) -> list[int]:
        """Updates, ascending, in which a loop came into the graph or left it."""
        loops: set[Pair] = set()
        found = []
        for one in self.verdicts:
            if one.accepted != (one.pair in loops):
                loops ^= {one.pair}
                found.append(one.update)
        return sorted(set(found))

    def moment(self, at: int) -> Moment:
        """What the map was after the last update that is not after node ``at``."""
        row = int(np.searchsorted(self.ids, at, side="right"))
        update = self.ids[row - 1] if row else at
        tiers: dict[int, Tier] = {}
        done = bisect_right(self.moves, at, key=lambda move: move.id)
        for move in self.moves[:done]:
            tiers.update(move.tiers)
        last = {one.pair: one for one in self.verdicts[: bisect_right(self.verdicts, at, key=lambda one: one.update)]}
        best_id, value = self._belief(int(update))
        return Moment(
            at=at,
            tiers=tiers if self.moves else self.snapshot.tiers,
            loops={pair: one.type for pair, one in last.items() if one.accepted},
            refused=tuple(pair for pair, one in last.items() if not one.accepted),
            best_id=best_id,
            value=value,
            T_map_base=self.moves[done - 1].T_map_base if done and self.moves[done - 1].id == update else None,
        )

    def _updates(self) -> tuple[list[int], list[float]]:
        """Updates that left a trace: moves or statistics; of a file without both, each node stands for one."""
        nodes = self.snapshot.all_nodes
        stamps: dict[int, float] = dict(zip(nodes.ids.tolist(), nodes.stamps.tolist(), strict=True))
        measured: dict[int, float] = dict(
            zip(self.statistics.ids.tolist(), self.statistics.stamps.tolist(), strict=True)
        )
        ids = measured.keys() | {move.id for move in self.moves} or stamps.keys()
        chosen = sorted(i for i in ids if i in stamps or i in measured)
        return chosen, [stamps[i] if i in stamps else measured[i] for i in chosen]

    def _belief(self, update: int) -> tuple[int, float]:
        table = self.statistics
        row = int(np.searchsorted(table.ids, update))
        if row == len(table.ids) or table.ids[row] != update:
            return 0, float("nan")
        best_id, value = (float(table.values[name][row]) if name in table.values else np.nan for name in _BELIEF)
        return (int(best_id) if np.isfinite(best_id) else 0), value


def _turned(snapshot: Snapshot, moves: Sequence[Move]) -> Sequence[Move]:
    """The moves with poses as they are since people turned the whole map: that is no part of its history.

    A map is turned between two sessions; what a later one recorded is in the new frame.
    """
    turns = [
        (entry.time, entry.placement.T_new_old)
        for entry in snapshot.journal
        if entry.action == "turn" and entry.undone_by is None and entry.placement is not None
    ]
    if not turns:
        return moves
    started = {row.map_id: row.started or 0.0 for row in snapshot.reader.sessions(snapshot.faults)}
    table = snapshot.all_nodes
    begun = {
        node_id: started.get(map_id, 0.0)
        for node_id, map_id in zip(table.ids.tolist(), table.map_ids.tolist(), strict=True)
    }
    found = []
    for move in moves:
        T = move.T_map_base
        for time, T_new_old in turns:
            if T is not None and T_new_old is not None and begun.get(move.id, 0.0) < time:
                T = T_new_old @ T
        found.append(replace(move, T_map_base=T))
    return found


def _verdicts(snapshot: Snapshot) -> Iterator[Verdict]:
    """What slamdeck recorded of each candidate; of loops without a record, that they came with their newer node.

    What a search for more loops looked at afterwards (UserClosure) was no part of any update.
    """
    recorded: set[Pair] = set()
    for row in snapshot.candidate_rows:
        candidate = row.candidate
        if candidate.type is LinkType.USER_CLOSURE:
            continue
        pair = (min(candidate.from_id, candidate.to_id), max(candidate.from_id, candidate.to_id))
        recorded.add(pair)
        yield Verdict(row.update_id, pair, candidate.type, candidate.refusal is None)
    for pair, link in _before_decisions(snapshot).items():
        if link is not None and link.type.is_loop and pair not in recorded:
            yield Verdict(max(pair), pair, link.type, accepted=True)


def _before_decisions(snapshot: Snapshot) -> dict[Pair, Link | None]:
    """The links as they were before anybody decided about one."""
    return snapshot.links | {entry.pair: entry.link_before for entry in reversed(snapshot.journal)}
