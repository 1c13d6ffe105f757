"""A map as it was after one of its updates: what the 3D view shows of it."""

from __future__ import annotations

import threading
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass

from server.browse.grid_then import GridThen
from server.browse.poses_then import PosesThen
from server.browse.timeline import Moment, Timeline
from slam.errors import OptimizationError
from slam.geometry import Pose
from slam.graph.components import components
from slam.types import OccupancyGrid

#: How long a grid is put together at a time while somebody scrubs, and for who stays, seconds.
SHARE_S, PATIENT_S = 0.02, 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Then:
    """A moment with all that is to be seen of it.

    Attributes:
        moment: nodes, tiers and loops.
        poses: id -> ``T_map_base`` of then; None where nodes are shown at the poses of now.
        grid: of then, None where nothing was known or it was not asked for.
        is_complete: whether waiting would bring poses of then, or more of the grid.
        failure: why there are no poses of then and never will be.
    """

    moment: Moment
    poses: Mapping[int, Pose] | None
    grid: OccupancyGrid | None
    is_complete: bool
    failure: str | None = None


class Past:
    """The moments of one timeline; for any number of threads, one after the other."""

    def __init__(self, timeline: Timeline, grids: GridThen) -> None:
        self.timeline = timeline
        self._poses = PosesThen(timeline)
        self._grids = grids
        self._orders: dict[int, list[int]] = {}
        self._lock = threading.Lock()

    def at(self, at: int, *, with_grid: bool, patient: bool, probable: bool = False) -> Then:
        """What the map was after the last update that is not after node ``at``.

        Poses that take long to work out are those of now unless the caller is ``patient``; the grid goes with them.
        """
        with self._lock:
            return self._then(at, with_grid=with_grid, patient=patient, probable=probable)

    def _then(self, at: int, *, with_grid: bool, patient: bool, probable: bool) -> Then:
        moment, poses, failure = self.timeline.moment(at), None, None
        quick = self._poses.is_quick(at)
        if patient or quick:
            try:
                poses = self._poses.poses(at)
            except OptimizationError as error:
                failure = str(error)
        grid, complete = None, True
        if with_grid:
            grid, complete = self._grid(at, poses, PATIENT_S if patient else SHARE_S, probable=probable)
        return Then(moment, poses, grid, complete and (poses is not None or failure is not None), failure)

    def _grid(
        self, at: int, poses: Mapping[int, Pose] | None, seconds: float, *, probable: bool
    ) -> tuple[OccupancyGrid | None, bool]:
        """Of the sessions that were one map with that of the robot."""
        turn, snapshot = self._poses.turn(at), self.timeline.snapshot
        order = self._order(turn, at)
        token = (snapshot.revision, order[0] if order else 0, len(order), None if poses is None else turn)
        shown = snapshot.poses if poses is None else poses
        return self._grids.at(token, order, bisect_right(order, at), shown, seconds, probable=probable)

    def _order(self, turn: int, at: int) -> list[int]:
        """All nodes, ascending, of the sessions that loops up to a turning point joined with the one of ``at``."""
        known = self._orders.get(turn)
        if known is None:
            nodes = self.timeline.snapshot.nodes
            session_of = dict(zip(nodes.ids.tolist(), nodes.map_ids.tolist(), strict=True))
            loops = [pair for pair in self.timeline.moment(at).loops if set(pair) <= session_of.keys()]
            piece_of = components(set(session_of.values()), ((session_of[a], session_of[b]) for a, b in loops))
            newest = max((i for i in session_of if i <= at), default=None)
            robots = None if newest is None else piece_of[session_of[newest]]
            known = self._orders[turn] = [i for i, session in session_of.items() if piece_of[session] == robots]
        return known
