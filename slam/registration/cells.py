"""Points sorted into cubic cells: thinning, nearest neighbours and normals in the time it takes to look at them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
_BITS = 21
_MIDDLE = 1 << (_BITS - 1)
_FREE = -1
#: Cells around a point that are searched for the neighbours of its normal, on each side.
_RINGS = 3
#: The cells to look into along each axis, the point's own first.
_STEPS = (0, -1, 1)
#: A plane takes so many points.
_FEWEST = 3
#: Scatter, as a share of its mean, below which points are all one, or on a line.
_FLAT = 1e-6


class Cells(NamedTuple):
    """Points by cell: those of cell c are ``rows[starts[c] : starts[c + 1]]``; an open hash table finds c.

    Attributes:
        points: (N, 3) metres.
        size: side of a cell, metres.
        keys: (S,) key of the cell in each slot, -1 for a free one; S is a power of two.
        ids: (S,) number of the cell in each slot.
        rows: (N,) rows of the points, by cell.
        starts: (C + 1,) where each cell starts in ``rows``.
    """

    points: Array
    size: float
    keys: Rows
    ids: Rows
    rows: Rows
    starts: Rows


@njit(cache=True, nogil=True)
def _cell(coordinate: float, size: float) -> int:
    return int(np.floor(coordinate / size))


@njit(cache=True, nogil=True)
def _gap(x: float, y: float, z: float, cx: int, cy: int, cz: int, size: float) -> float:
    """Squared distance of a point from a cell, a hair too small, so that rounding leaves no neighbour out."""
    dx = max(0.0, cx * size - x, x - (cx + 1) * size)
    dy = max(0.0, cy * size - y, y - (cy + 1) * size)
    dz = max(0.0, cz * size - z, z - (cz + 1) * size)
    return 0.999999 * (dx * dx + dy * dy + dz * dz)


@njit(cache=True, nogil=True)
def _key(x: int, y: int, z: int) -> int:
    return ((x + _MIDDLE) << (2 * _BITS)) | ((y + _MIDDLE) << _BITS) | (z + _MIDDLE)


@njit(cache=True, nogil=True)
def _slot(keys: Rows, key: int) -> int:
    """The slot that holds a key, or the free one where it belongs."""
    mask = len(keys) - 1
    # The upper bits of a product with an odd constant are well mixed (Knuth 1998, section 6.4).
    mixed = (key ^ (key >> 29)) * 0x9E3779B97F4A7C1
    slot = (mixed ^ (mixed >> 32)) & mask
    while keys[slot] != _FREE and keys[slot] != key:
        slot = (slot + 1) & mask
    return slot


@njit(cache=True, nogil=True)
def _assign(points: Array, size: float) -> tuple[Rows, Rows, Rows, int]:
    """Table of the cells in the order they are met: keys, numbers, the cell of each point, and how many there are."""
    slots = 16
    while slots < 2 * len(points):
        slots *= 2
    keys, ids = np.full(slots, _FREE, np.int64), np.zeros(slots, np.int64)
    cell_of = np.zeros(len(points), np.int64)
    count = 0
    for i in range(len(points)):
        key = _key(_cell(points[i, 0], size), _cell(points[i, 1], size), _cell(points[i, 2], size))
        slot = _slot(keys, key)
        if keys[slot] == _FREE:
            keys[slot], ids[slot] = key, count
            count += 1
        cell_of[i] = ids[slot]
    return keys, ids, cell_of, count


@njit(cache=True, nogil=True)
def thinned(points: Array, size: float) -> Array:
    """The mean (M, 3) of the points (N, 3) in each cube of side ``size`` metres, in the order they are met."""
    _, _, cell_of, count = _assign(points, size)
    sums, numbers = np.zeros((count, 3)), np.zeros(count)
    for i in range(len(points)):
        numbers[cell_of[i]] += 1.0
        for a in range(3):
            sums[cell_of[i], a] += points[i, a]
    return sums / numbers.reshape(-1, 1)


@njit(cache=True, nogil=True)
def sort(points: Array, size: float) -> Cells:
    """The points (N, 3) by cubes of side ``size`` metres."""
    keys, ids, cell_of, count = _assign(points, size)
    starts = np.zeros(count + 1, np.int64)
    for i in range(len(points)):
        starts[cell_of[i] + 1] += 1
    starts = np.cumsum(starts)
    at, rows = starts[:-1].copy(), np.zeros(len(points), np.int64)
    for i in range(len(points)):
        rows[at[cell_of[i]]] = i
        at[cell_of[i]] += 1
    return Cells(points, size, keys, ids, rows, starts)


@njit(cache=True, nogil=True)
def nearest(cells: Cells, queries: Array, radius: float) -> tuple[Rows, Array]:
    """Row of the nearest point within ``radius`` (at most the cells' size) of each query, -1 for none; its squared
    distance (M,), infinite for none.
    """
    points = cells.points
    found, squared = np.full(len(queries), -1, np.int64), np.full(len(queries), np.inf)
    for i in range(len(queries)):
        x, y, z = queries[i, 0], queries[i, 1], queries[i, 2]
        cx, cy, cz = _cell(x, cells.size), _cell(y, cells.size), _cell(z, cells.size)
        best, best_row = radius * radius, -1
        for visit in range(27):
            dx, dy, dz = _STEPS[visit // 9], _STEPS[visit // 3 % 3], _STEPS[visit % 3]
            if _gap(x, y, z, cx + dx, cy + dy, cz + dz, cells.size) > best:
                continue
            slot = _slot(cells.keys, _key(cx + dx, cy + dy, cz + dz))
            if cells.keys[slot] == _FREE:
                continue
            cell = cells.ids[slot]
            for k in range(cells.starts[cell], cells.starts[cell + 1]):
                row = cells.rows[k]
                d = (points[row, 0] - x) ** 2 + (points[row, 1] - y) ** 2 + (points[row, 2] - z) ** 2
                if d < best or (d == best and (best_row < 0 or row < best_row)):
                    best, best_row = d, row
        if best_row >= 0:
            found[i], squared[i] = best_row, best
    return found, squared


@njit(cache=True, nogil=True)
def normals(cells: Cells, neighbours: int) -> Array:
    """Unit normals (N, 3) of the planes through each point's nearest ``neighbours``; NaN where there are too few.

    They point towards the origin, where the sensor is taken to be: a surface is seen from its outside.
    """
    points = cells.points
    normal = np.full((len(points), 3), np.nan)
    rows, squared = np.zeros(neighbours, np.int64), np.zeros(neighbours)
    for i in range(len(points)):
        count = _closest(cells, points[i, 0], points[i, 1], points[i, 2], rows, squared)
        if count >= _FEWEST:
            _plane(points, rows, count, normal[i])
            if normal[i, 0] * points[i, 0] + normal[i, 1] * points[i, 1] + normal[i, 2] * points[i, 2] > 0:
                normal[i] = -normal[i]
    return normal


@njit(cache=True, nogil=True)
def _plane(points: Array, rows: Rows, count: int, normal: Array) -> None:
    """Fills in the unit normal of the plane through some points; leaves NaN where they lie on a line.

    The least eigenvalue of their scatter comes from the cubic's trigonometric solution (Smith 1961), its vector from
    the rows of what is left: a fifth of the time of a general eigensolver.
    """
    mx = my = mz = 0.0
    for k in range(count):
        mx += points[rows[k], 0] / count
        my += points[rows[k], 1] / count
        mz += points[rows[k], 2] / count
    xx = xy = xz = yy = yz = zz = 0.0
    for k in range(count):
        dx, dy, dz = points[rows[k], 0] - mx, points[rows[k], 1] - my, points[rows[k], 2] - mz
        xx += dx * dx
        xy += dx * dy
        xz += dx * dz
        yy += dy * dy
        yz += dy * dz
        zz += dz * dz
    mean = (xx + yy + zz) / 3.0
    if mean <= 0.0:
        return
    a, b, c = (xx - mean) / mean, (yy - mean) / mean, (zz - mean) / mean
    d, e, f = xy / mean, xz / mean, yz / mean
    p = np.sqrt((a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f)) / 6.0)
    if p < _FLAT:
        return
    half = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / (2.0 * p * p * p)
    least = 2.0 * p * np.cos((np.arccos(min(max(half, -1.0), 1.0)) + 2.0 * np.pi) / 3.0)
    a, b, c = a - least, b - least, c - least
    # Two rows span what is perpendicular to the vector: the longest of their three cross products is it.
    x1, y1, z1 = d * f - e * b, e * d - a * f, a * b - d * d
    x2, y2, z2 = d * c - e * f, e * e - a * c, a * f - d * e
    x3, y3, z3 = b * c - f * f, f * e - d * c, d * f - b * e
    n1, n2, n3 = x1 * x1 + y1 * y1 + z1 * z1, x2 * x2 + y2 * y2 + z2 * z2, x3 * x3 + y3 * y3 + z3 * z3
    if n2 >= n1 and n2 >= n3:
        x1, y1, z1, n1 = x2, y2, z2, n2
    elif n3 > n1:
        x1, y1, z1, n1 = x3, y3, z3, n3
    if n1 > _FLAT * _FLAT:
        scale = 1.0 / np.sqrt(n1)
        normal[0], normal[1], normal[2] = scale * x1, scale * y1, scale * z1


@njit(cache=True, nogil=True)
def _closest(cells: Cells, x: float, y: float, z: float, rows: Rows, squared: Array) -> int:
    """Fills in the rows of the points nearest to a place, nearest first; returns how many there are."""
    points, most, count = cells.points, len(rows), 0
    cx, cy, cz = _cell(x, cells.size), _cell(y, cells.size), _cell(z, cells.size)
    for ring in range(_RINGS + 1):
        # What lies in the next ring is at least this far away.
        if count == most and squared[most - 1] <= (max(ring - 1, 0) * cells.size) ** 2:
            break
        for dx in range(-ring, ring + 1):
            for dy in range(-ring, ring + 1):
                for dz in range(-ring, ring + 1):
                    if max(abs(dx), abs(dy), abs(dz)) != ring:
                        continue
                    if count == most and _gap(x, y, z, cx + dx, cy + dy, cz + dz, cells.size) > squared[most - 1]:
                        continue
                    slot = _slot(cells.keys, _key(cx + dx, cy + dy, cz + dz))
                    if cells.keys[slot] == _FREE:
                        continue
                    cell = cells.ids[slot]
                    for k in range(cells.starts[cell], cells.starts[cell + 1]):
                        row = cells.rows[k]
                        d = (points[row, 0] - x) ** 2 + (points[row, 1] - y) ** 2 + (points[row, 2] - z) ** 2
                        if count == most and d >= squared[most - 1]:
                            continue
                        at = min(count, most - 1)
                        while at > 0 and squared[at - 1] > d:
                            squared[at], rows[at] = squared[at - 1], rows[at - 1]
                            at -= 1
                        squared[at], rows[at] = d, row
                        count = min(count + 1, most)
    return count
