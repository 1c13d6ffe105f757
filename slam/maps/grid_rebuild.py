"""The global grid of a map whose poses were changed by decisions."""

from __future__ import annotations

from slam.database import MapReader, MapWriter
from slam.graph.graph import PoseGraph
from slam.maps.global_grid import GlobalGrid
from slam.params import Params


class GridRebuild:
    """Makes the grid anew from the local ones; the first time it reads them all.

    Attributes:
        is_due: whether poses changed since it was last made.
    """

    def __init__(self, reader: MapReader, writer: MapWriter, graph: PoseGraph, params: Params) -> None:
        self.is_due = False
        self._reader = reader
        self._writer = writer
        self._graph = graph
        self._params = params
        self._grid: GlobalGrid | None = None

    def carry_out(self) -> None:
        """Make it and store it."""
        if self._grid is None:
            self._grid = self._from_local_grids()
        else:
            self._grid.move(self._graph.poses)
        if len(self._grid):
            self._writer.save_grid(self._grid.occupancy())
        self.is_due = False

    def _from_local_grids(self) -> GlobalGrid:
        grid = GlobalGrid(self._params)
        for node_id, T_map_base in sorted(self._graph.poses.items()):
            local = self._reader.local_grid(node_id)
            if local is not None:
                grid.add(node_id, local, T_map_base)
        return grid
