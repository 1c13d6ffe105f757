"""Where in the image key points are taken, how many in each cell, and how exactly they are placed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.features.key_points import KeyPoints
from slam.params.groups import KpGroup, VisGroup
from slam.params.roi import parsed_ratios

#: The parameters that say which key points are wanted: those of words, or those of odometry and registration.
Wanted = KpGroup | VisGroup

#: Depth is looked up among a pixel's neighbours, so that these must be in the image.
_BORDER = 2


@dataclass(frozen=True, slots=True)
class Region:
    """A part of the image, cut into a grid of cells; pixels from (x0, y0) up to, not including, (x1, y1)."""

    x0: int
    y0: int
    x1: int
    y1: int
    rows: int
    cols: int

    @classmethod
    def of(cls, shape: tuple[int, ...], wanted: Wanted) -> Region:
        """By ``RoiRatios``, ``GridRows`` and ``GridCols``, for an image of (height, width)."""
        height, width = shape[:2]
        left, right, top, bottom = parsed_ratios(wanted.RoiRatios)
        x1, y1 = width - int(right * width), height - int(bottom * height)
        return cls(int(left * width), int(top * height), x1, y1, wanted.GridRows, wanted.GridCols)

    @property
    def cells(self) -> int:
        """Number of cells."""
        return self.rows * self.cols

    def inside(self, pixels: NDArray[np.number]) -> NDArray[np.bool_]:
        """(N,) which of the pixels (N, 2) lie in the region."""
        return np.asarray(((pixels >= (self.x0, self.y0)) & (pixels < (self.x1, self.y1))).all(axis=1))

    def cell_of(self, pixels: NDArray[np.number]) -> NDArray[np.int64]:
        """(N,) number of the cell of each pixel of the region."""
        across = ((pixels[:, 0] - self.x0) * self.cols / (self.x1 - self.x0)).astype(np.int64)
        down = ((pixels[:, 1] - self.y0) * self.rows / (self.y1 - self.y0)).astype(np.int64)
        return np.asarray(np.clip(down, 0, self.rows - 1) * self.cols + np.clip(across, 0, self.cols - 1))

    def share(self, ordered: NDArray[np.int64], pixels: NDArray[np.number], limit: int) -> NDArray[np.int64]:
        """The first rows of ``ordered``, at most ``limit`` in all and the same number in each cell."""
        if self.cells == 1:
            return ordered[:limit]
        cell = self.cell_of(pixels[ordered])
        by_cell = np.argsort(cell, kind="stable")
        first = np.searchsorted(cell[by_cell], cell[by_cell])
        place = np.empty(len(cell), np.int64)
        place[by_cell] = np.arange(len(cell)) - first
        return ordered[place < max(1, limit // self.cells)][:limit]


def strongest(found: KeyPoints, shape: tuple[int, ...], wanted: Wanted, limit: int) -> NDArray[np.int64]:
    """Rows of the key points that are kept, strongest first: in the region, an equal share in each cell."""
    region = Region.of(shape, wanted)
    height, width = shape[:2]
    inner = ((found.pixels >= _BORDER) & (found.pixels <= (width - 1 - _BORDER, height - 1 - _BORDER))).all(axis=1)
    order = np.argsort(-found.responses, kind="stable")
    order = order[(inner & region.inside(found.pixels))[order]]
    return region.share(order, found.pixels, limit)


def refined(gray: NDArray[np.uint8], found: KeyPoints, wanted: Wanted) -> KeyPoints:
    """Key points moved to the corner near by, by ``SubPixIterations``; the same where that is 0."""
    if wanted.SubPixIterations == 0 or len(found) == 0:
        return found
    window = (wanted.SubPixWinSize, wanted.SubPixWinSize)
    stop = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, wanted.SubPixIterations, wanted.SubPixEps)
    moved = np.asarray(cv2.cornerSubPix(gray, found.pixels[:, None].copy(), window, (-1, -1), stop), np.float32)[:, 0]
    height, width = gray.shape
    inner = ((moved >= _BORDER) & (moved <= (width - 1 - _BORDER, height - 1 - _BORDER))).all(axis=1, keepdims=True)
    return replace(found, pixels=np.where(inner, moved, found.pixels))
