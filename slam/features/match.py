"""Matching descriptors: near a projected point, or against all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.features.distances import distance
from slam.features.hamming import FAR, pack
from slam.features.kind import check_kind
from slam.types import Descriptors

#: A match may differ in at most this many of 256 bits.
MAX_DISTANCE = 80
#: A match of float descriptors may differ by this share of both squared lengths: of unit ones, a cosine of 3/4.
MAX_SHARE = 0.25


def match_near(
    predicted: NDArray[np.float32],
    descriptors_from: Descriptors,
    pixels_to: NDArray[np.float32],
    descriptors_to: Descriptors,
    *,
    radius: float,
    ratio: float,
) -> NDArray[np.int32]:
    """Matches between points with a predicted pixel and key points within ``radius`` pixels of it.

    Args:
        predicted: (N, 2) predicted pixels of the points, NaN where one is not expected in view.
        descriptors_from: (N, B) of the points; those of both sides are of one kind.
        pixels_to: (M, 2) key points of the image.
        descriptors_to: (M, B) of the key points.
        radius: pixels.
        ratio: largest ratio of nearest to second nearest distance, which is squared for float descriptors.

    Returns:
        (K, 2) int32 rows (point, key point), each row of either side at most once, ascending in the point.
    """
    if len(pixels_to) == 0 or len(predicted) == 0:
        return np.zeros((0, 2), np.int32)
    cells, starts, shape = _grid(pixels_to, radius)
    rows_from, rows_to, far, limits = _comparable(descriptors_from, descriptors_to)
    return np.asarray(
        _match_near(
            predicted.astype(np.float32),
            rows_from,
            pixels_to,
            rows_to,
            cells,
            starts,
            shape,
            float(radius),
            float(ratio),
            far,
            limits,
        )
    )


def match_all(descriptors_from: Descriptors, descriptors_to: Descriptors, *, ratio: float) -> NDArray[np.int32]:
    """Matches (K, 2) of all against all that are each other's nearest and pass the ratio test."""
    if len(descriptors_from) == 0 or len(descriptors_to) < 2:
        return np.zeros((0, 2), np.int32)
    rows_from, rows_to, far, limits = _comparable(descriptors_from, descriptors_to)
    return np.asarray(_match_all(rows_from, rows_to, float(ratio), far, limits))


def _comparable(
    descriptors_from: Descriptors, descriptors_to: Descriptors
) -> tuple[NDArray[Any], NDArray[Any], float, NDArray[Any]]:
    """Both sides as compiled code compares them, what is farther than any distance, and the largest one of a match."""
    check_kind(descriptors_from, descriptors_to)
    if descriptors_from.dtype != np.float32:
        limit = MAX_DISTANCE * 8 * descriptors_from.shape[1] // 256
        limits = np.full(len(descriptors_from), limit, np.int64)
        return pack(np.asarray(descriptors_from)), pack(np.asarray(descriptors_to)), FAR, limits
    lengths = np.einsum("ij,ij->i", descriptors_from, descriptors_from)
    limits = (2.0 * MAX_SHARE * lengths).astype(np.float32)
    return np.ascontiguousarray(descriptors_from), np.ascontiguousarray(descriptors_to), np.inf, limits


def _grid(pixels: NDArray[np.float32], cell: float) -> tuple[NDArray[np.int32], NDArray[np.int32], tuple[int, int]]:
    """Rows of ``pixels`` sorted by cell, where each cell starts, and the number of cells (y, x)."""
    cols = int(pixels[:, 0].max() // cell) + 1
    rows = int(pixels[:, 1].max() // cell) + 1
    index = (pixels[:, 1] // cell).astype(np.int32) * cols + (pixels[:, 0] // cell).astype(np.int32)
    order = np.argsort(index, kind="stable").astype(np.int32)
    starts = np.searchsorted(index[order], np.arange(rows * cols + 1)).astype(np.int32)
    return order, starts, (rows, cols)


@njit(cache=True, nogil=True)
def _match_near(
    predicted: NDArray[np.float32],
    words_from: NDArray[Any],
    pixels_to: NDArray[np.float32],
    words_to: NDArray[Any],
    cells: NDArray[np.int32],
    starts: NDArray[np.int32],
    shape: tuple[int, int],
    radius: float,
    ratio: float,
    far: float,
    limits: NDArray[Any],
) -> NDArray[np.int32]:
    rows, cols = shape
    owner = np.full(len(pixels_to), -1, np.int32)
    owner_distance = np.full(len(pixels_to), far, limits.dtype)
    for i in range(len(predicted)):
        u, v = predicted[i, 0], predicted[i, 1]
        if np.isnan(u):
            continue
        cx, cy = int(np.floor(u / radius)), int(np.floor(v / radius))
        best, second, best_row = far, far, -1
        left, right = max(0, cx - 1), min(cols, cx + 2)
        if left >= right:
            continue
        for y in range(max(0, cy - 1), min(rows, cy + 2)):
            # The cells of a row lie one behind the other.
            for k in range(starts[y * cols + left], starts[y * cols + right]):
                row = cells[k]
                du, dv = pixels_to[row, 0] - u, pixels_to[row, 1] - v
                if du * du + dv * dv > radius * radius:
                    continue
                d = distance(words_from[i], words_to[row])
                if d < best:
                    best, second, best_row = d, best, row
                elif d < second:
                    second = d
        if best_row < 0 or best > limits[i] or best > ratio * second:
            continue
        if best < owner_distance[best_row]:
            owner[best_row], owner_distance[best_row] = i, best
    return _pairs(owner, len(predicted))


@njit(cache=True, nogil=True)
def _match_all(
    words_from: NDArray[Any], words_to: NDArray[Any], ratio: float, far: float, limits: NDArray[Any]
) -> NDArray[np.int32]:
    owner = np.full(len(words_to), -1, np.int32)
    owner_distance = np.full(len(words_to), far, limits.dtype)
    best_of = np.full(len(words_from), -1, np.int32)
    for i in range(len(words_from)):
        best, second, best_row = far, far, -1
        for j in range(len(words_to)):
            d = distance(words_from[i], words_to[j])
            if d < best:
                best, second, best_row = d, best, j
            elif d < second:
                second = d
            if d < owner_distance[j]:
                owner[j], owner_distance[j] = i, d
        if best <= limits[i] and best <= ratio * second:
            best_of[i] = best_row
    for j in range(len(words_to)):
        if owner[j] >= 0 and best_of[owner[j]] != j:
            owner[j] = -1
    return _pairs(owner, len(words_from))


@njit(cache=True, nogil=True)
def _pairs(owner: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """(K, 2) rows (from, to) of ``owner[to] = from``, ascending in from."""
    to_of = np.full(count, -1, np.int32)
    for j in range(len(owner)):
        if owner[j] >= 0:
            to_of[owner[j]] = j
    found = np.empty((count, 2), np.int32)
    k = 0
    for i in range(count):
        if to_of[i] >= 0:
            found[k, 0] = i
            found[k, 1] = to_of[i]
            k += 1
    return found[:k].copy()
