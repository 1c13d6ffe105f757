"""The floor plan of the whole map: the nodes' local grids, put together in log odds at their optimised poses."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.errors import ParameterError
from slam.geometry import Pose
from slam.maps.kernels import touch_cells
from slam.maps.local_grid import yaw
from slam.params import Params
from slam.types import LocalGrid, OccupancyGrid

#: Cells by which the arrays outgrow what is needed, so that they don't grow with every node.
_SPARE = 128


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """A local grid with what of its node's pose was used: x, y in metres and yaw in radians."""

    local: LocalGrid
    where: tuple[float, float, float]
    reach: float


class GlobalGrid:
    """Incremental occupancy grid (RTAB-Map's section "Global": ``GridGlobal/`` parameters).

    A node changes a cell once, an obstacle outweighs free space of the same node, and a cell that a newer node has
    touched is not changed by an older one. When a pose moves by more than ``GridGlobal/UpdateError`` everything is
    made anew from the local grids, in order of ids.

    Attributes:
        params: the ``GridGlobal/`` group; replace it when a parameter that works live has changed.
    """

    def __init__(self, params: Params) -> None:
        self.params = params
        self._placed: dict[int, _Placed] = {}
        self._clear()

    def __len__(self) -> int:
        return len(self._placed)

    def copy(self) -> GlobalGrid:
        """A grid of its own with the same cells; the local grids are shared, as nobody changes them."""
        other = GlobalGrid(self.params)
        other._placed, other._origin = dict(self._placed), self._origin
        other._odds, other._last = self._odds.copy(), self._last.copy()
        return other

    def add(self, node_id: int, local: LocalGrid, T_map_base: Pose) -> None:
        """Take in a node's local grid at its pose; cheap. A node that is there already is replaced, which is not."""
        known = node_id in self._placed
        self._placed[node_id] = _Placed(local, _planar(T_map_base), _reach(local))
        if known:
            self._rebuild()
        else:
            self._touch(node_id)

    def add_all(self, grids: Mapping[int, tuple[LocalGrid, Pose]]) -> None:
        """Take in many local grids at once: id -> grid and ``T_map_base``."""
        self._placed |= {i: _Placed(local, _planar(T), _reach(local)) for i, (local, T) in grids.items()}
        if grids:
            self._rebuild()

    def move(self, poses: Mapping[int, Pose]) -> bool:
        """Follow the optimised poses (id -> ``T_map_base``); nodes without one leave.

        Returns:
            Whether the grid was made anew.
        """
        if self.fits(poses):
            return False
        where = {i: _planar(poses[i]) for i in self._placed if i in poses}
        self._placed = {i: replace(self._placed[i], where=to) for i, to in where.items()}
        self._rebuild()
        return True

    def fits(self, poses: Mapping[int, Pose]) -> bool:
        """Whether all nodes have a pose, about where they are in the grid (``GridGlobal/UpdateError``)."""
        limit = self.params.GridGlobal.UpdateError
        return all(i in poses and _travel(one, _planar(poses[i])) <= limit for i, one in self._placed.items())

    def follow(self, poses: Mapping[int, Pose], node_ids: Iterable[int]) -> bool:
        """Note where some nodes are now, for the next ``rebuild``; whether any is farther off than allowed."""
        where = {i: _planar(poses[i]) for i in node_ids if i in self._placed}
        limit = self.params.GridGlobal.UpdateError
        if all(_travel(self._placed[i], to) <= limit for i, to in where.items()):
            return False
        self._placed |= {i: replace(self._placed[i], where=to) for i, to in where.items()}
        return True

    def leave_out(self, node_id: int) -> bool:
        """Forget a node's local grid at the next ``rebuild``; whether it was there."""
        return self._placed.pop(node_id, None) is not None

    @property
    def size(self) -> int:
        """Number of cells in the arrays."""
        return int(self._odds.size)

    def rebuild(self) -> None:
        """Make everything anew from the local grids."""
        self._rebuild()

    def occupancy(self) -> OccupancyGrid | None:
        """The grid cropped to what is known, None when nothing is.

        A cell of log odds 0 is unknown, as in RTAB-Map. Turned local grids leave out single cells; such a gap between
        free cells is free.
        """
        threshold = _log_odds(self.params.GridGlobal.OccupancyThr)
        return self._cropped(
            lambda odds: _without_gaps(np.where(odds == 0, -1, np.where(odds >= threshold, 100, 0)).astype(np.int8))
        )

    def probability(self) -> OccupancyGrid | None:
        """The same with the probability of each known cell to be occupied, in percent."""
        return self._cropped(
            lambda odds: np.where(odds == 0, -1, np.rint(100.0 / (1.0 + np.exp(-odds.astype(np.float64))))).astype(
                np.int8
            )
        )

    def _cropped(self, cells_of: Callable[[NDArray[np.float32]], NDArray[np.int8]]) -> OccupancyGrid | None:
        rows, columns = np.nonzero(self._last.any(axis=1))[0], np.nonzero(self._last.any(axis=0))[0]
        if not len(rows):
            return None
        cells = cells_of(self._odds[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])
        size = self.params.Grid.CellSize
        x_min, y_min = (self._origin[0] + columns[0]) * size, (self._origin[1] + rows[0]) * size
        return OccupancyGrid(cells, float(x_min), float(y_min), size)

    def _clear(self) -> None:
        self._odds: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self._last: NDArray[np.int32] = np.zeros((0, 0), dtype=np.int32)
        self._origin = (0, 0)

    def _rebuild(self) -> None:
        self._clear()
        for node_id in sorted(self._placed):
            self._touch(node_id)

    def _touch(self, node_id: int) -> None:
        placed, grid = self._placed[node_id], self.params.GridGlobal
        self._grow(placed)
        local = placed.local
        hit, miss = _log_odds(grid.ProbHit), _log_odds(grid.ProbMiss)
        bounds = _log_odds(grid.ProbClampingMin), _log_odds(grid.ProbClampingMax)
        x, y, turn = placed.where
        frame = np.array([np.cos(turn), np.sin(turn), x, y, self.params.Grid.CellSize])
        for cells, change in ((local.obstacles, hit), (local.ground, miss), (local.empty, miss)):
            touch_cells(self._odds, self._last, self._origin, cells, frame, node_id, change, bounds)

    def _grow(self, placed: _Placed) -> None:
        """Make room for all cells within reach of a node."""
        size, (x, y, _) = self.params.Grid.CellSize, placed.where
        low = [int(np.floor((v - placed.reach) / size)) - 1 for v in (x, y)]
        high = [int(np.floor((v + placed.reach) / size)) + 2 for v in (x, y)]
        rows, columns = self._odds.shape
        if rows:
            old_low, old_high = self._origin, (self._origin[0] + columns, self._origin[1] + rows)
            if all(low[k] >= old_low[k] and high[k] <= old_high[k] for k in (0, 1)):
                return
            low = [old_low[k] if low[k] >= old_low[k] else low[k] - _SPARE for k in (0, 1)]
            high = [old_high[k] if high[k] <= old_high[k] else high[k] + _SPARE for k in (0, 1)]
        odds = np.zeros((high[1] - low[1], high[0] - low[0]), dtype=np.float32)
        last = np.zeros(odds.shape, dtype=np.int32)
        if rows:
            row, column = self._origin[1] - low[1], self._origin[0] - low[0]
            odds[row : row + rows, column : column + columns] = self._odds
            last[row : row + rows, column : column + columns] = self._last
        self._odds, self._last, self._origin = odds, last, (low[0], low[1])


def fitting(params: Params, local: LocalGrid) -> Params:
    """Parameters with the cell size that a map's local grids have; as they are where no grid may have that."""
    try:
        return params.changed({"Grid/CellSize": local.cell_size})
    except ParameterError:
        return params


def _without_gaps(cells: NDArray[np.int8]) -> NDArray[np.int8]:
    """Cells with the unknown ones free that have three free neighbours of four and no occupied one."""
    around = np.pad(cells, 1, constant_values=-1)
    neighbors = np.stack([around[:-2, 1:-1], around[2:, 1:-1], around[1:-1, :-2], around[1:-1, 2:]])
    gap = (cells == -1) & ((neighbors == 0).sum(axis=0) >= 3) & (neighbors != 100).all(axis=0)
    return np.where(gap, 0, cells).astype(np.int8)


def _log_odds(probability: float) -> float:
    """ln(p / (1 - p)), finite for 0 and 1 too."""
    p = min(max(probability, 1e-6), 1 - 1e-6)
    return float(np.log(p / (1 - p)))


def _planar(T_map_base: Pose) -> tuple[float, float, float]:
    return float(T_map_base[0, 3]), float(T_map_base[1, 3]), yaw(T_map_base)


def _reach(local: LocalGrid) -> float:
    """Distance of the farthest cell from the node, metres."""
    cells = [c for c in (local.ground, local.obstacles, local.empty) if len(c)]
    return float(max((np.hypot(c[:, 0], c[:, 1]).max() for c in cells), default=0.0))


def _travel(placed: _Placed, to: tuple[float, float, float]) -> float:
    """The farthest that a cell of a node moves with its pose, metres, at least about so."""
    x, y, turn = placed.where
    angle = abs(float(np.arctan2(np.sin(turn - to[2]), np.cos(turn - to[2]))))
    return float(np.hypot(x - to[0], y - to[1])) + placed.reach * angle
