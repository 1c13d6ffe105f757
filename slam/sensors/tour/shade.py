"""Colour of each pixel from the faces' textures, filtered over the pixel's footprint."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: Most samples along the long axis of a footprint.
MAX_SAMPLES = 6


@njit(cache=True, nogil=True)
def _add(
    texels: NDArray[np.uint8],
    at: int,
    width: int,
    height: int,
    u: float,
    v: float,
    weight: float,
    out: NDArray[np.float32],
) -> None:
    """Add a bilinear sample; u and v in texels of this level, centres at halves."""
    x = min(max(u - 0.5, 0.0), width - 1.000001)
    y = min(max(v - 0.5, 0.0), height - 1.000001)
    x0, y0 = int(x), int(y)
    ax, ay = x - x0, y - y0
    row0 = at + (y0 * width + x0) * 3
    row1 = row0 + width * 3
    w11 = ax * ay * weight
    w01, w10 = ax * weight - w11, ay * weight - w11
    w00 = weight - w01 - w10 - w11
    for c in range(3):
        out[c] += (
            w00 * texels[row0 + c] + w01 * texels[row0 + 3 + c] + w10 * texels[row1 + c] + w11 * texels[row1 + 3 + c]
        )


@njit(cache=True, nogil=True)
def _sample(
    texels: NDArray[np.uint8],
    levels: NDArray[np.int64],
    plane: NDArray[np.float64],
    ray_x: float,
    ray_y: float,
    step_x: float,
    step_y: float,
    weight: float,
    out: NDArray[np.float32],
) -> None:
    """Add the colour of a face where a ray meets it.

    ``levels`` (L, 3) is offset, width and height of each mip level, ``plane`` (3, 3) takes the ray (x, y, 1) to
    homogeneous texture coordinates of level 0, steps are one pixel in ray coordinates.
    """
    a = plane[0, 0] * ray_x + plane[0, 1] * ray_y + plane[0, 2]
    b = plane[1, 0] * ray_x + plane[1, 1] * ray_y + plane[1, 2]
    z = 1.0 / (plane[2, 0] * ray_x + plane[2, 1] * ray_y + plane[2, 2])
    u, v = a * z, b * z
    ux, vx = (plane[0, 0] - u * plane[2, 0]) * z * step_x, (plane[1, 0] - v * plane[2, 0]) * z * step_x
    uy, vy = (plane[0, 1] - u * plane[2, 1]) * z * step_y, (plane[1, 1] - v * plane[2, 1]) * z * step_y
    length_x, length_y = np.sqrt(ux * ux + vx * vx), np.sqrt(uy * uy + vy * vy)
    if length_x > length_y:
        long_u, long_v, long, short = ux, vx, length_x, length_y
    else:
        long_u, long_v, long, short = uy, vy, length_y, length_x
    samples = min(max(int(np.ceil(long / max(short, 1e-9) - 0.25)), 1), MAX_SAMPLES)
    level = min(max(np.log2(max(long / samples, 1e-9)), 0.0), len(levels) - 1.001)
    low = int(level)
    blend = level - low
    share = weight / samples
    for i in range(samples):
        t = (i + 0.5) / samples - 0.5
        su, sv = u + t * long_u, v + t * long_v
        for k in range(2):
            part = share * (blend if k else 1.0 - blend)
            if part > 0.0:
                scale = 1.0 / (1 << (low + k))
                at, width, height = levels[low + k]
                _add(texels, at, width, height, su * scale, sv * scale, part, out)


@njit(cache=True, nogil=True)
def shade(
    face: NDArray[np.int32],
    planes: NDArray[np.float64],
    texels: NDArray[np.uint8],
    levels: NDArray[np.int64],
    K: NDArray[np.float64],
    image: NDArray[np.float32],
) -> None:
    """Fill ``image`` (H, W, 3) with the colours of the faces that ``visible`` found."""
    height, width = face.shape
    step_x, step_y = 1.0 / K[0, 0], 1.0 / K[1, 1]
    for y in range(height):
        ray_y = (y - K[1, 2]) * step_y
        for x in range(width):
            f = face[y, x]
            out = image[y, x]
            out[:] = 0.0
            if f >= 0:
                _sample(texels, levels[f], planes[f], (x - K[0, 2]) * step_x, ray_y, step_x, step_y, 1.0, out)
