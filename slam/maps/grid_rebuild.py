"""The global grid of a map whose poses and nodes were changed by decisions."""

from __future__ import annotations

import logging
from collections.abc import Generator

from slam.database import MapReader, MapWriter
from slam.errors import DatabaseError
from slam.graph.graph import PoseGraph
from slam.maps.global_grid import GlobalGrid, fitting
from slam.params import Params
from slam.types import LocalGrid

_LOG = logging.getLogger(__name__)


class GridRebuild:
    """Makes the grid anew from the local ones, node by node, so that who does it can attend to others in between.

    The first time it reads them all; what was read stays, also where a change of the poses comes in between. A local
    grid that is damaged is left out.
    """

    def __init__(self, reader: MapReader, writer: MapWriter, graph: PoseGraph, params: Params) -> None:
        self._reader = reader
        self._writer = writer
        self._graph = graph
        self._params = params
        self._grid = GlobalGrid(params)
        self._nodes: list[int] = []
        self._locals: dict[int, LocalGrid | None] = {}
        self._parts: Generator[None, None, bool] | None = None
        self._is_begun = False

    @property
    def is_due(self) -> bool:
        """Whether poses changed since it was last made."""
        return self._parts is not None

    @property
    def is_begun(self) -> bool:
        """Whether some of that is done."""
        return self._is_begun

    def poses_changed(self) -> None:
        """It has to be made anew, from the beginning where that has begun."""
        self._parts, self._is_begun = self._made(), False

    def locals_changed(self) -> None:
        """Local grids of the file are others: they are read anew."""
        self._locals.clear()
        self._nodes = []
        self.poses_changed()

    def step(self) -> bool:
        """Do some more of it; whether the grid is in the file now."""
        if self._parts is None:
            return False
        self._is_begun = True
        try:
            next(self._parts)
        except StopIteration as end:
            self._parts, self._is_begun = None, False
            return bool(end.value)
        return False

    def carry_out(self) -> bool:
        """Make it and store it at once; whether there is one."""
        if not self.is_due:
            self.poses_changed()
        stored = False
        while self.is_due:
            stored = self.step()
        return stored

    def _made(self) -> Generator[None, None, bool]:
        with_grid = self._reader.nodes_with_grid().tolist()
        for node_id in with_grid:
            if node_id in self._graph.poses and node_id not in self._locals:
                self._locals[node_id] = self._local(node_id)
                yield
        placed = {i: local for i in with_grid if i in self._graph.poses and (local := self._locals[i]) is not None}
        if list(placed) != self._nodes or not self._grid.fits(self._graph.poses):
            grid = GlobalGrid(next((fitting(self._params, one) for one in placed.values()), self._params))
            for node_id, local in placed.items():
                grid.add(node_id, local, self._graph.poses[node_id])
                yield
            self._grid, self._nodes = grid, list(placed)
        if self._nodes:
            self._writer.save_grid(self._grid.occupancy())
        return bool(self._nodes)

    def _local(self, node_id: int) -> LocalGrid | None:
        try:
            return self._reader.local_grid(node_id)
        except DatabaseError as error:
            _LOG.warning("left out of the floor plan: %s", error)
            return None
