"""The global grid of a map whose poses and nodes were changed by decisions."""

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
        self._seen: set[int] = set()

    def carry_out(self) -> None:
        """Make it and store it."""
        if self._grid is None:
            self._grid = GlobalGrid(self._params)
        else:
            self._grid.move(self._graph.poses)
        # All of them at first; later those that came back into the map.
        for node_id in sorted(self._graph.poses.keys() - self._seen):
            local = self._reader.local_grid(node_id)
            if local is not None:
                self._grid.add(node_id, local, self._graph.poses[node_id])
        self._seen = set(self._graph.poses)
        if len(self._grid):
            self._writer.save_grid(self._grid.occupancy())
        self.is_due = False
