"""Corner strength: the smaller eigenvalue of the gradients' second moments (Shi and Tomasi 1994)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: A Sobel gradient of an 8-bit image over a step of its whole range is 4 * 255.
_SOBEL_RANGE = 4.0 * 255.0
#: Sums over larger blocks may not fit in 32 bits.
LARGEST_BLOCK = 45


def min_eigenvalue(gray: NDArray[np.uint8], block: int, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
    """(H, W) smaller eigenvalue of the sum of gradient products over ``block`` x ``block`` pixels.

    The same as OpenCV's ``cornerMinEigenVal`` with a Sobel aperture of 3, to the rounding of floats; sums are whole
    numbers here, and thus exact. Beyond its border the image is its own mirror.

    Args:
        gray: (H, W).
        block: at most ``LARGEST_BLOCK``.
        out: filled and returned where it has the image's shape: new memory costs as much as the arithmetic.
    """
    strength = out if out is not None and out.shape == gray.shape else np.empty(gray.shape, np.float32)
    if min(gray.shape) < 2:
        strength[:] = 0.0
        return strength
    before, after = block // 2, block - 1 - block // 2
    rows, cols = (_mirrored(size, before, after) for size in gray.shape)
    _fill(gray, rows, cols, block, strength)
    return strength


def _mirrored(size: int, before: int, after: int) -> NDArray[np.int64]:
    """Rows -before .. size - 1 + after of an axis, those outside mirrored about the first and the last one."""
    period = 2 * (size - 1)
    index = np.abs(np.arange(-before, size + after)) % period
    return np.asarray(np.minimum(index, period - index))


@njit(cache=True, nogil=True)
def _fill(
    gray: NDArray[np.uint8],
    rows: NDArray[np.int64],
    cols: NDArray[np.int64],
    block: int,
    strength: NDArray[np.float32],
) -> None:
    """One pass over the rows; the sums of the last ``block`` rows are kept running."""
    height, width = strength.shape
    wide = width + block - 1
    products, scratch = np.zeros((block, 3, wide), np.int32), np.zeros((4, width + 2), np.int32)
    sums, wider = np.zeros((3, wide), np.int32), np.zeros((3, wide), np.int32)
    scale = np.float32(0.5 / (_SOBEL_RANGE * block) ** 2)
    for k in range(len(rows)):
        y, line = rows[k], products[k % block]
        above, below = abs(y - 1), min(y + 1, abs(2 * height - 3 - y))
        _add(sums, line, -1)
        _gradient_products(gray[above], gray[y], gray[below], cols, block // 2, scratch, line)
        _add(sums, line, 1)
        if k >= block - 1:
            _sum_across(sums, block, width, wider)
            _smaller(wider, scale, strength[k - block + 1])


@njit(cache=True, nogil=True)
def _gradient_products(
    above: NDArray[np.uint8],
    here: NDArray[np.uint8],
    below: NDArray[np.uint8],
    cols: NDArray[np.int64],
    first: int,
    scratch: NDArray[np.int32],
    out: NDArray[np.int32],
) -> None:
    """Fills (3, W + block - 1) with gx gx, gx gy and gy gy of a row, mirrored at both ends; ``first`` is column 0.

    Loops that write one array each are the ones that the compiler makes wide.
    """
    width = len(here)
    smooth, steep, gx, gy = scratch[0], scratch[1], scratch[2], scratch[3]
    for x in range(width):
        smooth[x + 1] = above[x] + 2 * here[x] + below[x]
    for x in range(width):
        steep[x + 1] = below[x] - above[x]
    smooth[0], smooth[width + 1] = smooth[2], smooth[width - 1]
    steep[0], steep[width + 1] = steep[2], steep[width - 1]
    for x in range(width):
        gx[x] = smooth[x + 2] - smooth[x]
    for x in range(width):
        gy[x] = steep[x] + 2 * steep[x + 1] + steep[x + 2]
    xx, xy, yy = out[0, first:], out[1, first:], out[2, first:]
    for x in range(width):
        xx[x] = gx[x] * gx[x]
    for x in range(width):
        xy[x] = gx[x] * gy[x]
    for x in range(width):
        yy[x] = gy[x] * gy[x]
    for part in range(3):
        for x in range(first):
            out[part, x] = out[part, first + cols[x]]
        for x in range(first + width, len(cols)):
            out[part, x] = out[part, first + cols[x]]


@njit(cache=True, nogil=True)
def _add(sums: NDArray[np.int32], row: NDArray[np.int32], sign: int) -> None:
    for part in range(3):
        total, line = sums[part], row[part]
        for x in range(len(total)):
            total[x] += sign * line[x]


@njit(cache=True, nogil=True)
def _sum_across(sums: NDArray[np.int32], block: int, width: int, out: NDArray[np.int32]) -> None:
    for part in range(3):
        line, total = sums[part], out[part]
        for x in range(width):
            total[x] = line[x]
        for k in range(1, block):
            for x in range(width):
                total[x] += line[x + k]


@njit(cache=True, nogil=True)
def _smaller(moments: NDArray[np.int32], scale: np.float32, out: NDArray[np.float32]) -> None:
    """Smaller eigenvalue of [[a, b], [b, c]], ``scale`` being half of the moments' unit."""
    xx, xy, yy = moments[0], moments[1], moments[2]
    for x in range(len(out)):
        a, b, c = np.float32(xx[x]) * scale, np.float32(xy[x]) * (scale + scale), np.float32(yy[x]) * scale
        out[x] = (a + c) - np.float32(math.sqrt((a - c) * (a - c) + b * b))
