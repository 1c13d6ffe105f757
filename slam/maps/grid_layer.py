"""The occupancy grid of a running map, or nothing in its place (``RGBD/CreateOccupancyGrid``)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.maps.global_grid import GlobalGrid
from slam.maps.local_grid import level, make_local_grid
from slam.params import Params
from slam.types import Frame, Link, LocalGrid, OccupancyGrid

#: The local grid of a node of the map file, None where it has none.
LoadGrid = Callable[[int], LocalGrid | None]

#: Local grids that each new node may put into the global grid again, and cells that it may store.
_TOUCHES, _CELLS = 100, 500_000


class GridLayer:
    """Makes the local grids and keeps the global one at the optimised poses."""

    def __init__(self, params: Params, stored: LoadGrid | None = None) -> None:
        """An empty grid; ``stored`` gives the local grids of nodes of earlier sessions, once a loop joins them."""
        self._global = GlobalGrid(params)
        self._stored = stored
        self._known: set[int] = set()
        self._is_behind = False
        self._touches = self._cells = 0

    def add(self, node_id: int, frame: Frame, poses: Mapping[int, Pose], params: Params) -> LocalGrid | None:
        """The local grid of a node, taken into the global one; None when grids are switched off, or nothing is known.

        A replayed frame whose depth image is not there any more has the grid that was stored.
        """
        if not params.RGBD.CreateOccupancyGrid:
            return None
        self._global.params = params
        local = None if frame.stored is None else frame.stored.grid
        if local is None and not frame.depth_m.size:
            return None
        if local is None or frame.depth_m.any():
            local = make_local_grid(frame.depth_m, frame.camera, level(poses[node_id]), params)
        self._known.add(node_id)
        self._touches, self._cells = self._touches + _TOUCHES, self._cells + _CELLS
        self._global.add(node_id, local, poses[node_id])
        return local

    def join(self, graph: PoseGraph, links: Iterable[Link], params: Params) -> None:
        """Takes in the stored grids of the earlier sessions that these links joined with the one that runs."""
        if self._stored is None or not params.RGBD.CreateOccupancyGrid:
            return
        for link in links:
            if link.to_id not in self._known:
                joined = sorted(graph.component(link.to_id) - self._known)
                self._known.update(joined)
                grids = ((node_id, self._stored(node_id)) for node_id in joined)
                self._global.add_all({i: (grid, graph.poses[i]) for i, grid in grids if grid is not None})

    def leave_out(self, node_id: int) -> None:
        """A node is no part of the map any more; its cells go when the grid is next made anew."""
        self._known.discard(node_id)
        self._is_behind |= self._global.leave_out(node_id)

    def follow(self, poses: Mapping[int, Pose], moved: Iterable[int]) -> None:
        """Follows those poses that moved; a large grid is made anew seldom, so that each node bears a small share."""
        self._is_behind |= self._global.follow(poses, moved)
        if self._is_behind and self._touches >= len(self._global):
            self.catch_up()

    def catch_up(self) -> None:
        """Makes the grid anew where poses have moved since it was last made."""
        if self._is_behind:
            self._global.rebuild()
            self._is_behind, self._touches = False, 0

    def move(self, poses: Mapping[int, Pose]) -> None:
        """Follows all poses at once."""
        if not self._global.move(poses) and self._is_behind:
            self._global.rebuild()
        self._is_behind = False

    def occupancy_in_turn(self) -> OccupancyGrid | None:
        """The global grid to store now; None when that would cost too much for one node, or nothing is known."""
        if self._cells < self._global.size:
            return None
        self._cells = 0
        return self.occupancy()

    def occupancy(self) -> OccupancyGrid | None:
        """The global grid, None while nothing is known."""
        return self._global.occupancy()
