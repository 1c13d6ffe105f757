"""ORB-SLAM's way to choose ORB key points: evenly over the image on every pyramid level (Mur-Artal 2015)."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.features.key_points import KeyPoints
from slam.features.region import Wanted, strongest
from slam.params import Params

#: Cells of this side fall back on ``FAST/MinThreshold`` one by one.
_CELL_PX = 30
_DEEPEST = 12


class OrbOctree:
    """FAST corners on each level of the pyramid, spread by a quadtree, with the angle of their intensity centroid."""

    def detect(self, gray: NDArray[np.uint8], wanted: Wanted, limit: int, params: Params) -> KeyPoints:
        """Up to ``limit`` corners, strongest first."""
        levels, scale = params.ORB.NLevels, params.ORB.ScaleFactor
        shares = scale ** -np.arange(levels, dtype=np.float64)
        parts = []
        for level, share in enumerate(limit * shares / shares.sum()):
            size = (round(gray.shape[1] / scale**level), round(gray.shape[0] / scale**level))
            image = gray if level == 0 else np.asarray(cv2.resize(gray, size), np.uint8)
            parts.append(_on_level(image, level, max(1, round(share)), params))
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        found = KeyPoints(columns[0], columns[1], columns[2], columns[3], columns[4])
        return found.take(strongest(found, gray.shape, wanted, limit))


def _on_level(
    image: NDArray[np.uint8], level: int, limit: int, params: Params
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.int32]]:
    """Columns of the key points of one level, in the pixels of the whole image."""
    fast = cv2.FastFeatureDetector.create(params.FAST.MinThreshold, nonmaxSuppression=True)
    found = KeyPoints.from_cv(fast.detect(image, None))
    edge = params.ORB.EdgeThreshold + 1
    inner = ((found.pixels >= edge) & (found.pixels < (image.shape[1] - edge, image.shape[0] - edge))).all(axis=1)
    pixels, responses = found.pixels[inner], found.responses[inner]
    kept = _clear(pixels, responses, params.FAST.Threshold)
    pixels, responses = pixels[kept], responses[kept]
    rows = spread_by_quadtree(pixels, responses, limit)
    pixels, responses = pixels[rows], responses[rows]
    scale = np.float32(params.ORB.ScaleFactor**level)
    angles = _centroid_angles(image, pixels.astype(np.int32), params.ORB.PatchSize // 2)
    sizes = np.full(len(rows), params.ORB.PatchSize * scale, np.float32)
    return pixels * scale, sizes, angles, responses, np.full(len(rows), level, np.int32)


def _clear(pixels: NDArray[np.float32], responses: NDArray[np.float32], threshold: float) -> NDArray[np.bool_]:
    """Which corners reach the threshold, or lie in a cell where none does."""
    if len(pixels) == 0:
        return np.zeros(0, np.bool_)
    column, row = (pixels // _CELL_PX).astype(np.int64).T
    cell = row * (int(column.max()) + 1) + column
    best = np.zeros(int(cell.max()) + 1)
    np.maximum.at(best, cell, responses)
    return np.asarray((responses >= threshold) | (best[cell] < threshold))


def spread_by_quadtree(pixels: NDArray[np.float32], responses: NDArray[np.float32], limit: int) -> NDArray[np.int64]:
    """Rows of the strongest key point of each cell of a quadtree with ``limit`` cells.

    Cells are halved both ways, all of them while there are few enough, then the fullest first.
    """
    if len(pixels) <= limit:
        return np.arange(len(pixels))
    side = float(pixels.max()) + 1.0
    cells = np.zeros(len(pixels), np.int64)
    for depth in range(1, _DEEPEST):
        column, row = (pixels * (2**depth / side)).astype(np.int64).T
        finer = (row << _DEEPEST) + column
        if len(np.unique(finer)) > limit:
            cells = _split_fullest(cells, finer, limit)
            break
        cells = finer
    order = np.lexsort((np.arange(len(pixels)), -responses, cells))
    first = np.ones(len(order), np.bool_)
    first[1:] = cells[order[1:]] != cells[order[:-1]]
    return np.sort(order[first][:limit])


def _split_fullest(cells: NDArray[np.int64], finer: NDArray[np.int64], limit: int) -> NDArray[np.int64]:
    """The cells, of which the fullest are replaced by their quarters while there are no more than ``limit``."""
    names, cell, counts = np.unique(cells, return_inverse=True, return_counts=True)
    pairs = np.unique(np.column_stack([cell, finer]), axis=0)
    quarters = np.bincount(pairs[:, 0], minlength=len(names))
    fullest = np.argsort(-counts, kind="stable")
    split = np.zeros(len(names), np.bool_)
    split[fullest] = len(names) + np.cumsum(quarters[fullest] - 1) <= limit
    return np.where(split[cell], finer, -1 - cell)


@njit(cache=True, nogil=True)
def _centroid_angles(image: NDArray[np.uint8], pixels: NDArray[np.int32], radius: int) -> NDArray[np.float32]:
    """Degrees from the middle of each disc to its centre of brightness (Rosin 1999), 0 to 360."""
    height, width = image.shape
    angles = np.empty(len(pixels), np.float32)
    for i in range(len(pixels)):
        mx, my = 0.0, 0.0
        for dy in range(-radius, radius + 1):
            y = min(height - 1, max(0, pixels[i, 1] + dy))
            reach = int(np.sqrt(radius * radius - dy * dy))
            for dx in range(-reach, reach + 1):
                value = float(image[y, min(width - 1, max(0, pixels[i, 0] + dx))])
                mx += dx * value
                my += dy * value
        angles[i] = np.degrees(np.arctan2(my, mx)) % 360.0
    return angles
