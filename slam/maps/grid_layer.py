"""The occupancy grid of a running map, or nothing in its place (``RGBD/CreateOccupancyGrid``)."""

from __future__ import annotations

from collections.abc import Mapping

from slam.geometry import Pose
from slam.maps.global_grid import GlobalGrid
from slam.maps.local_grid import level, make_local_grid
from slam.params import Params
from slam.types import Frame, LocalGrid, OccupancyGrid


class GridLayer:
    """Makes the local grids and keeps the global one at the optimised poses."""

    def __init__(self, params: Params) -> None:
        self._global = GlobalGrid(params)

    def add(self, node_id: int, frame: Frame, poses: Mapping[int, Pose], params: Params) -> LocalGrid | None:
        """The local grid of a node, taken into the global one; None when grids are switched off."""
        if not params.RGBD.CreateOccupancyGrid:
            return None
        self._global.params = params
        local = make_local_grid(frame.depth_m, frame.camera, level(poses[node_id]), params)
        self._global.add(node_id, local, poses[node_id])
        return local

    def move(self, poses: Mapping[int, Pose]) -> None:
        """Follows the optimised poses."""
        self._global.move(poses)

    def occupancy(self) -> OccupancyGrid | None:
        """The global grid, None while nothing is known."""
        return self._global.occupancy()
