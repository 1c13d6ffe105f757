"""The loops over pixels and cells that numpy has no words for, compiled by numba at first use."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: Neighbours on each side in the decimated image that a normal is fitted to.
_REACH = 2
#: Samples whose depth differs by a larger share belong to another surface.
_SAME_SURFACE = 0.12
_FEWEST = 5

Mask = NDArray[np.bool_]


@njit(cache=True, nogil=True)
def normals(
    z: NDArray[np.float32], x: NDArray[np.float32], y: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Surface normals of a depth image, towards the camera, in the optical frame.

    A plane n P = d is linear in inverse depth, 1 / z = (n / d) (x, y, 1); so its normal is the least squares fit of
    1 / z over a window (Hager et al. 2007 use the same for stereo).

    Args:
        z: (h, w) depth, 0 where unknown.
        x: (w,) x / z of the columns.
        y: (h,) y / z of the rows.

    Returns:
        (h, w, 3) unit normals, and (h, w) 0 no surface, 1 too thin for a normal, 2 with normal.
    """
    h, w = z.shape
    normal = np.zeros((h, w, 3))
    found = np.zeros((h, w), np.uint8)
    for row in range(h):
        for col in range(w):
            centre = z[row, col]
            if centre <= 0:
                continue
            n = sx = sy = sxx = sxy = syy = sw = sxw = syw = 0.0
            for i in range(max(row - _REACH, 0), min(row + _REACH + 1, h)):
                dy = y[i] - y[row]
                for k in range(max(col - _REACH, 0), min(col + _REACH + 1, w)):
                    if z[i, k] <= 0 or abs(z[i, k] - centre) > _SAME_SURFACE * centre:
                        continue
                    dx = x[k] - x[col]
                    inverse = 1.0 / z[i, k]
                    n += 1.0
                    sx += dx
                    sy += dy
                    sxx += dx * dx
                    sxy += dx * dy
                    syy += dy * dy
                    sw += inverse
                    sxw += dx * inverse
                    syw += dy * inverse
            if n < _FEWEST:
                continue
            found[row, col] = 1
            mx, my, mw = sx / n, sy / n, sw / n
            cxx, cxy, cyy = sxx / n - mx * mx, sxy / n - mx * my, syy / n - my * my
            cxw, cyw = sxw / n - mx * mw, syw / n - my * mw
            det = cxx * cyy - cxy * cxy
            if det <= 1e-3 * (cxx + cyy) ** 2:
                continue
            a = (cyy * cxw - cxy * cyw) / det
            b = (cxx * cyw - cxy * cxw) / det
            c = mw - a * (mx + x[col]) - b * (my + y[row])
            norm = np.sqrt(a * a + b * b + c * c)
            if norm <= 0:
                continue
            # n P = d with d > 0 points away from the camera.
            normal[row, col, 0] = -a / norm
            normal[row, col, 1] = -b / norm
            normal[row, col, 2] = -c / norm
            found[row, col] = 2
    return normal, found


@njit(cache=True, nogil=True)
def grow_ground(flat: Mask, height: NDArray[np.float64], floor: float, band: float, max_step: float) -> Mask:
    """Cells reached from the floor over flat cells in steps of at most ``max_step`` metres of height.

    Args:
        flat: (h, w) cells with a flat surface.
        height: (h, w) its height, metres.
        floor: height of the floor; NaN gives no ground.
        band: cells this near to the floor's height start the growth, metres.
        max_step: largest difference of height between neighbours.
    """
    h, w = flat.shape
    ground = np.zeros((h, w), np.bool_)
    stack = np.empty((h * w, 2), np.int64)
    top = 0
    for row in range(h):
        for col in range(w):
            if flat[row, col] and abs(height[row, col] - floor) <= band:
                ground[row, col] = True
                stack[top, 0] = row
                stack[top, 1] = col
                top += 1
    while top > 0:
        top -= 1
        row, col = stack[top]
        for i in range(max(row - 1, 0), min(row + 2, h)):
            for k in range(max(col - 1, 0), min(col + 2, w)):
                if flat[i, k] and not ground[i, k] and abs(height[i, k] - height[row, col]) <= max_step:
                    ground[i, k] = True
                    stack[top, 0] = i
                    stack[top, 1] = k
                    top += 1
    return ground


@njit(cache=True, nogil=True)
def trace_rays(obstacle: Mask, row: float, col: float) -> Mask:
    """Cells that a ray from (row, col), in cells, passes on its way to each obstacle cell until it meets one."""
    h, w = obstacle.shape
    free = np.zeros((h, w), np.bool_)
    for i in range(h):
        for k in range(w):
            if not obstacle[i, k]:
                continue
            d_row, d_col = i + 0.5 - row, k + 0.5 - col
            steps = int(np.ceil(2.0 * max(abs(d_row), abs(d_col))))
            for s in range(steps):
                at_row, at_col = int(row + d_row * s / steps), int(col + d_col * s / steps)
                if obstacle[at_row, at_col]:
                    break
                free[at_row, at_col] = True
    return free


@njit(cache=True, nogil=True)
def touch_cells(
    odds: NDArray[np.float32],
    last: NDArray[np.int32],
    origin: tuple[int, int],
    cells: NDArray[np.float32],
    frame: NDArray[np.float64],
    node_id: int,
    change: float,
    bounds: tuple[float, float],
) -> None:
    """Add ``change`` to the log odds of the cells of one node, each once, unless the same or a newer node was there.

    Args:
        odds: (H, W) log odds, changed in place.
        last: (H, W) id of the newest node that touched a cell, 0 for none; changed in place.
        origin: column and row number, in the map, of the arrays' first cell.
        cells: (N, 2) centres in the node's levelled frame, metres.
        frame: cosine and sine of the node's yaw, its x and y, and the cell size, metres.
        node_id: positive.
        change: log odds to add.
        bounds: least and largest log odds kept.
    """
    c, s, x, y, size = frame[0], frame[1], frame[2], frame[3], frame[4]
    for k in range(len(cells)):
        column = int(np.floor((x + c * cells[k, 0] - s * cells[k, 1]) / size)) - origin[0]
        row = int(np.floor((y + s * cells[k, 0] + c * cells[k, 1]) / size)) - origin[1]
        if last[row, column] >= node_id:
            continue
        last[row, column] = node_id
        odds[row, column] = min(max(odds[row, column] + change, bounds[0]), bounds[1])
