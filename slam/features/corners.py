"""Choosing well spread corners, to a fraction of a pixel, from a map of corner strength."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True, nogil=True)
def local_maxima(
    strength: NDArray[np.float32], threshold: float, border: int
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Pixels (N, 2) x y, and their strength, that beat their eight neighbours; ``border`` pixels stay free."""
    height, width = strength.shape
    count = 0
    pixels = np.empty((height * width // 4, 2), np.int32)
    # Rows are compared as a whole, without branches; then eight pixels at a time are passed over where none is left.
    peak = np.zeros((width + 7) // 8 * 8, np.uint8)
    eights = peak.view(np.uint64)
    for y in range(border, height - border):
        _compare(strength[y - 1], strength[y], strength[y + 1], np.float32(threshold), border, peak)
        for eight in range(len(eights)):
            if eights[eight] == 0:
                continue
            for x in range(8 * eight, 8 * eight + 8):
                if peak[x]:
                    pixels[count, 0] = x
                    pixels[count, 1] = y
                    count += 1
    found = np.empty(count, np.float32)
    for i in range(count):
        found[i] = strength[pixels[i, 1], pixels[i, 0]]
    return pixels[:count].copy(), found


@njit(cache=True, nogil=True)
def _compare(
    above: NDArray[np.float32],
    here: NDArray[np.float32],
    below: NDArray[np.float32],
    threshold: np.float32,
    border: int,
    peak: NDArray[np.uint8],
) -> None:
    """1 where a pixel of the row beats its neighbours; of equal ones the first does."""
    before = border - 1
    a, b, c, out = above[before:], here[before:], below[before:], peak[border:]
    for x in range(len(here) - 2 * border):
        s = b[x + 1]
        out[x] = (
            (s > threshold)
            & (s > a[x])
            & (s > a[x + 1])
            & (s > a[x + 2])
            & (s > b[x])
            & (s >= b[x + 2])
            & (s >= c[x])
            & (s >= c[x + 1])
            & (s >= c[x + 2])
        )


@njit(cache=True, nogil=True)
def spread(
    pixels: NDArray[np.int32], order: NDArray[np.int64], shape: tuple[int, int], min_distance: float, limit: int
) -> NDArray[np.int64]:
    """Rows of ``pixels``, strongest first by ``order``, that keep ``min_distance`` pixels from each other."""
    # A square cell of this side has room for three such pixels, not for four.
    cell = max(1, int(min_distance))
    rows, cols = shape[0] // cell + 1, shape[1] // cell + 1
    taken = np.full((rows, cols, 3), -1, np.int64)
    chosen = np.empty(limit, np.int64)
    count = 0
    for row in order:
        x, y = pixels[row, 0], pixels[row, 1]
        cy, cx = y // cell, x // cell
        free = True
        for ny in range(max(0, cy - 1), min(rows, cy + 2)):
            for nx in range(max(0, cx - 1), min(cols, cx + 2)):
                for k in range(3):
                    other = taken[ny, nx, k]
                    if other >= 0:
                        dx, dy = pixels[other, 0] - x, pixels[other, 1] - y
                        if dx * dx + dy * dy < min_distance * min_distance:
                            free = False
        if not free:
            continue
        for k in range(3):
            if taken[cy, cx, k] < 0:
                taken[cy, cx, k] = row
                break
        chosen[count] = row
        count += 1
        if count == limit:
            break
    return chosen[:count].copy()


@njit(cache=True, nogil=True)
def refine(strength: NDArray[np.float32], pixels: NDArray[np.int32]) -> NDArray[np.float32]:
    """Sub-pixel positions (N, 2): the peak of the parabola through three neighbours, along x and along y."""
    refined = np.empty((pixels.shape[0], 2), np.float32)
    for i in range(pixels.shape[0]):
        x, y = pixels[i, 0], pixels[i, 1]
        centre = strength[y, x]
        for axis in range(2):
            before = strength[y, x - 1] if axis == 0 else strength[y - 1, x]
            after = strength[y, x + 1] if axis == 0 else strength[y + 1, x]
            curvature = before - 2.0 * centre + after
            offset = 0.5 * (before - after) / curvature if curvature < 0.0 else 0.0
            refined[i, axis] = pixels[i, axis] + min(0.5, max(-0.5, offset))
    return refined
