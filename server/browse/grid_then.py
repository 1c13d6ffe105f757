"""The occupancy grid as it was after each update of a map."""

from __future__ import annotations

import logging
import threading
import time
from collections import OrderedDict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from slam.database import MapReader
from slam.errors import DatabaseError
from slam.geometry import Array, Pose
from slam.maps.global_grid import GlobalGrid, fitting
from slam.params import Params
from slam.types import LocalGrid, OccupancyGrid

_LOG = logging.getLogger(__name__)
#: Nodes between two copies of a grid to go back to, at first; cells that the copies of one grid hold together.
_EVERY, _COPIED_CELLS = 16, 16_000_000
#: Grids at other poses that are kept, the one at the poses of now among them.
_KEPT = 3
#: A node that would make the grid larger than this is left out: its pose or its cells are nonsense.
_MOST_CELLS = 16_000_000


@dataclass(eq=False)
class _Course:
    """A grid that grows node by node along an order, and copies of it on the way.

    Attributes:
        order: ids in the order in which they come in; those of later nodes follow.
        grid: of the first ``count`` of them.
        copies: by their counts.
        every: nodes between two copies.
        box: least and greatest x and y of what may have been touched, metres.
    """

    order: Sequence[int]
    grid: GlobalGrid
    count: int = 0
    copies: dict[int, GlobalGrid] = field(default_factory=dict)
    every: int = _EVERY
    box: Array | None = None

    def has_room(self, local: LocalGrid, T_map_base: Pose) -> bool:
        """Whether the grid stays of a sensible size with a local grid at a pose; the room is taken then."""
        cells = np.concatenate([local.ground, local.obstacles, local.empty])
        reach = float(np.hypot(cells[:, 0], cells[:, 1]).max()) if len(cells) else 0.0
        box = np.array([T_map_base[:2, 3] - reach, T_map_base[:2, 3] + reach])
        if self.box is not None:
            box = np.array([np.minimum(box[0], self.box[0]), np.maximum(box[1], self.box[1])])
        if not np.prod((box[1] - box[0]) / self.grid.params.Grid.CellSize) <= _MOST_CELLS:
            return False
        self.box = box
        return True

    def back_to(self, count: int) -> None:
        """Go back to the nearest copy that has no more nodes than ``count``."""
        last = max((done for done in self.copies if done <= count), default=0)
        self.grid, self.count = (self.copies[last].copy() if last else GlobalGrid(self.grid.params)), last

    def remember(self) -> None:
        """Keep a copy from time to time, more rarely of a large grid."""
        if self.count % self.every == 0 and self.count not in self.copies:
            self.copies[self.count] = self.grid.copy()
            if sum(copy.size for copy in self.copies.values()) > _COPIED_CELLS and len(self.copies) > 1:
                self.every *= 2
                self.copies = {done: copy for done, copy in self.copies.items() if done % self.every == 0}


class GridThen:
    """Puts local grids together up to any node; for any number of threads, one after the other.

    Going on takes in the nodes between, going back begins at the last copy before. Local grids are read once.
    """

    def __init__(self, reader: MapReader, params: Params) -> None:
        self._reader = reader
        self._params = params
        self._locals: dict[int, LocalGrid | None] = {}
        self._courses: OrderedDict[Hashable, _Course] = OrderedDict()
        self._lock = threading.Lock()

    def at(
        self,
        token: Hashable,
        order: Sequence[int],
        count: int,
        poses: Mapping[int, Pose],
        seconds: float,
        *,
        probable: bool = False,
    ) -> tuple[OccupancyGrid | None, bool]:
        """The grid of the first ``count`` nodes of an order, and whether it is complete within the time given.

        Args:
            token: what the poses of the nodes depend on; the same token has the same order.
            order: ids, oldest first.
            count: how many of them were there.
            poses: id -> ``T_map_base`` of at least these.
            seconds: how long local grids may be put together; what is missing comes with the next call.
            probable: cells have their probability in percent, and not only whether they are occupied.
        """
        with self._lock:
            course = self._courses.setdefault(token, _Course(order, GlobalGrid(self._params)))
            self._courses.move_to_end(token)
            while len(self._courses) > _KEPT:
                self._courses.popitem(last=False)
            if course.count > count:
                course.back_to(count)
            until = time.perf_counter() + seconds
            while course.count < count and time.perf_counter() < until:
                self._take_in(course, course.order[course.count], poses)
            grid = course.grid.probability() if probable else course.grid.occupancy()
            return grid, course.count == count

    def _take_in(self, course: _Course, node_id: int, poses: Mapping[int, Pose]) -> None:
        local, T_map_base = self._local(node_id), poses.get(node_id)
        if local is not None and T_map_base is not None:
            if not len(course.grid):
                course.grid.params = fitting(self._params, local)
            if course.has_room(local, T_map_base):
                course.grid.add(node_id, local, T_map_base)
        course.count += 1
        course.remember()

    def _local(self, node_id: int) -> LocalGrid | None:
        if node_id not in self._locals:
            try:
                self._locals[node_id] = self._reader.local_grid(node_id)
            except DatabaseError as error:
                _LOG.info("no local grid: %s", error)
                self._locals[node_id] = None
        return self._locals[node_id]
