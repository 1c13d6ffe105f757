"""A node's scan and local grid seen from above: the base is in the middle, its x axis up, its y axis left."""

from __future__ import annotations

import json

import cv2
import numpy as np
from numpy.typing import NDArray

from server.browse.map_view import MapView
from server.browse.nodes import require_known, require_node
from server.browse.plan_reach import cell_count, grid_reach, scan_reach
from server.errors import EngineError, NotFoundError
from slam.edit.grids import changed, remade
from slam.edit.wishes import Regrid
from slam.types import LocalGrid

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

#: Pixels from the middle to an edge: a scan's, and a grid's at most (there a cell is a pixel where there is room).
_SCAN_HALF, _MOST_HALF = 320, 640
#: Blue, green, red, alpha of cells and of points without a value, to be seen on a light and on a dark page.
_EMPTY, _GROUND, _OBSTACLE = (170, 150, 130, 90), (96, 170, 52, 210), (70, 96, 235, 255)
_POINT = (220, 150, 50, 255)
#: Heights are coloured between these shares of all points.
_LEAST, _MOST = 2.0, 98.0
_FEW = 1500
_HAIR = 1e-3


def grid_picture(view: MapView, node_id: int, changes: str = "") -> bytes:
    """PNG of a node's local grid, transparent where nothing is known; NotFoundError where it has none.

    Its half side is ``grid_reach``, in the levelled base frame. With ``changes`` it is the one that those parameters
    would make, see ``trial_grid``.
    """
    require_known(view.snapshot(), node_id)
    grid = trial_grid(view, node_id, changes) if changes else view.reader.local_grid(node_id)
    if grid is None or not cell_count(grid):
        raise NotFoundError(f"node {node_id} has no local grid")
    return _png(grid_pixels(grid))


def trial_grid(view: MapView, node_id: int, changes: str) -> LocalGrid:
    """The local grid that a node would have with other parameters of ``Grid/``, a JSON object by name.

    Raises:
        NotFoundError: the map has no such node.
        EngineError: the changes are no such object.
        DecisionError: they are of other groups.
        ParameterError: a name is unknown, or a value out of bounds.
        DatabaseError: the node has no depth.
    """
    snapshot = view.snapshot()
    require_node(snapshot, node_id)
    try:
        wanted = json.loads(changes)
    except ValueError:
        wanted = None
    if not isinstance(wanted, dict):
        raise EngineError(f'changes is {changes[:40]!r}, and an object of parameters is right: {{"Grid/RangeMax": 3}}')
    params = changed(snapshot.params, Regrid(changes=wanted))
    return remade(view.reader, node_id, snapshot.poses[node_id], params)


def grid_pixels(grid: LocalGrid) -> Picture:
    """The picture of a grid (N, N, 4): blue, green, red and opacity."""
    reach = grid_reach(grid)
    half = min(_MOST_HALF, round(reach / grid.cell_size - 0.5))
    picture = np.zeros((2 * half + 1, 2 * half + 1, 4), np.uint8)
    for cells, colour in ((grid.empty, _EMPTY), (grid.ground, _GROUND), (grid.obstacles, _OBSTACLE)):
        picture[_pixels(cells.astype(np.float64), reach, len(picture))] = colour
    return picture


def scan_picture(view: MapView, node_id: int) -> bytes:
    """PNG of a node's scan: intensities where they are stored, else heights; NotFoundError where it has none.

    Its half side is ``scan_reach``.
    """
    require_known(view.snapshot(), node_id)
    stored = view.reader.stored_scan(node_id)
    if stored is None or not len(stored.scan):
        raise NotFoundError(f"node {node_id} has no scan")
    points = stored.scan.points_base.astype(np.float64)
    values = points[:, 2] if stored.intensities is None else stored.intensities.astype(np.float64)
    # What is highest is drawn last.
    order = np.argsort(points[:, 2], kind="stable")
    picture = np.zeros((2 * _SCAN_HALF, 2 * _SCAN_HALF, 4), np.uint8)
    rows, columns = _pixels(points[order, :2], scan_reach(points), len(picture))
    picture[rows, columns] = _coloured(values)[order]
    # Few points are drawn large enough to be seen.
    pixels = 5 if len(points) < _FEW else 3
    if len(points) < _SCAN_HALF**2 // 8:
        picture = cv2.dilate(picture, np.ones((pixels, pixels), np.uint8)).astype(np.uint8)
    return _png(picture)


def _pixels(places: Array, reach: float, side: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of places (N, 2) in a square picture: x goes up, y goes left."""
    # Centres of cells may be right between two pixels: a hair decides the same way for all of them.
    scaled = np.floor((1.0 - places / reach) * 0.5 * side + _HAIR).astype(np.int64).clip(0, side - 1)
    return scaled[:, 0], scaled[:, 1]


def _coloured(values: Array) -> Picture:
    """Colours (N, 4) of values (N,), from blue to red; all the same where the values are."""
    finite = np.nan_to_num(values, posinf=0.0, neginf=0.0)
    low, high = np.percentile(finite, [_LEAST, _MOST])
    if high - low < 1e-6:
        return np.tile(np.array(_POINT, np.uint8), (len(values), 1))
    share = np.rint(np.clip((finite - low) / (high - low), 0.0, 1.0) * 255.0).astype(np.uint8)
    colours = cv2.applyColorMap(share[:, None], cv2.COLORMAP_TURBO)[:, 0]
    return np.column_stack([colours, np.full(len(values), 255, np.uint8)]).astype(np.uint8)


def _png(picture: Picture) -> bytes:
    return bytes(cv2.imencode(".png", picture)[1])
