"""Colour of each pixel from the faces' textures, filtered over the pixel's footprint."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.sensors.tour.atlas import LEVELS

#: Most samples along the long axis of a footprint.
MAX_SAMPLES = 4
#: The footprint changes slowly; it is worked out anew this often along a row.
RUN_PX = 8
#: Weights of one pixel sum to at most this, so that three 8-bit channels fit side by side in 64 bits.
_ONE = 8192.0
_LANE = 21
#: Where in an edge pixel its four samples lie: no two share a row or a column.
_SAMPLES = ((-0.125, -0.375), (0.375, -0.125), (0.125, 0.375), (-0.375, 0.125))


@njit(cache=True, nogil=True)
def shade(
    face: NDArray[np.int32],
    planes: NDArray[np.float64],
    texels: NDArray[np.uint32],
    levels: NDArray[np.int64],
    K: NDArray[np.float64],
    image: NDArray[np.float32],
) -> None:
    """Fill ``image`` (H, W, 3) with the colours of the faces that ``visible`` found.

    Args:
        face: (H, W) face of each pixel, -1 for none.
        planes: (F, 3, 3), from a ray (x, y, 1) to homogeneous texture coordinates of level 0.
        texels: flat 0x00RRGGBB.
        levels: (F, LEVELS, 3) offset into texels, width, height.
        K: (3, 3) intrinsics.
        image: output, blue green red.
    """
    height, width = face.shape
    step_x, step_y = 1.0 / K[0, 0], 1.0 / K[1, 1]
    last = -1
    plane = planes[0]
    footprint = (1, 0, 0.0, 0.0, 0.0, 0.0)
    for y in range(height):
        ray_y = (y - K[1, 2]) * step_y
        for x in range(width):
            f = face[y, x]
            if f < 0:
                image[y, x, :] = 0.0
                continue
            ray_x = (x - K[0, 2]) * step_x
            fresh = f != last or x % RUN_PX == 0
            if f != last:
                last, plane = f, planes[f]
            z = 1.0 / (plane[2, 0] * ray_x + plane[2, 1] * ray_y + plane[2, 2])
            u = (plane[0, 0] * ray_x + plane[0, 1] * ray_y + plane[0, 2]) * z
            v = (plane[1, 0] * ray_x + plane[1, 1] * ray_y + plane[1, 2]) * z
            if fresh:
                footprint = _footprint(plane, u, v, z, step_x, step_y)
            blue, green, red = _filtered(texels, levels[f], footprint, u, v)
            image[y, x, 0], image[y, x, 1], image[y, x, 2] = blue, green, red


@njit(cache=True, nogil=True)
def smooth_edges(
    face: NDArray[np.int32],
    planes: NDArray[np.float64],
    texels: NDArray[np.uint32],
    levels: NDArray[np.int64],
    K: NDArray[np.float64],
    image: NDArray[np.float32],
) -> None:
    """Where neighbours see different faces, replace the colour by the mean of four rays through the pixel."""
    height, width = face.shape
    step_x, step_y = 1.0 / K[0, 0], 1.0 / K[1, 1]
    near = np.empty(5, np.int32)
    for y in range(1, height - 1):
        for x in range(1, width - 1):
            f = face[y, x]
            if f == face[y, x - 1] and f == face[y, x + 1] and f == face[y - 1, x] and f == face[y + 1, x]:
                continue
            near[0], near[1], near[2], near[3], near[4] = (
                f,
                face[y, x - 1],
                face[y, x + 1],
                face[y - 1, x],
                face[y + 1, x],
            )
            blue, green, red = 0.0, 0.0, 0.0
            for dx, dy in _SAMPLES:
                ray_x, ray_y = (x + dx - K[0, 2]) * step_x, (y + dy - K[1, 2]) * step_y
                seen = _nearest(near, planes, levels, ray_x, ray_y)
                plane = planes[seen]
                z = 1.0 / (plane[2, 0] * ray_x + plane[2, 1] * ray_y + plane[2, 2])
                u = (plane[0, 0] * ray_x + plane[0, 1] * ray_y + plane[0, 2]) * z
                v = (plane[1, 0] * ray_x + plane[1, 1] * ray_y + plane[1, 2]) * z
                footprint = _footprint(plane, u, v, z, 0.5 * step_x, 0.5 * step_y)
                b, g, r = _filtered(texels, levels[seen], footprint, u, v)
                blue, green, red = blue + b, green + g, red + r
            image[y, x, 0], image[y, x, 1], image[y, x, 2] = 0.25 * blue, 0.25 * green, 0.25 * red


@njit(cache=True, nogil=True)
def finish(
    image: NDArray[np.float32], noise: NDArray[np.float32], start: int, sigma: float, out: NDArray[np.uint8]
) -> None:
    """Add sensor noise from a table (its length a power of two), begun at ``start``, and round to 8 bits."""
    values, bytes_out = image.reshape(-1), out.reshape(-1)
    mask = len(noise) - 1
    for i in range(len(values)):
        value = values[i] + sigma * noise[(start + i) & mask] + 0.5
        bytes_out[i] = np.uint8(min(max(value, 0.0), 255.0))


@njit(cache=True, nogil=True)
def _nearest(
    candidates: NDArray[np.int32],
    planes: NDArray[np.float64],
    levels: NDArray[np.int64],
    ray_x: float,
    ray_y: float,
) -> int:
    """The nearest of the faces that a ray meets; the first one when it meets none of them."""
    best, best_inverse_z = int(candidates[0]), 0.0
    for i in range(len(candidates)):
        f = int(candidates[i])
        if f < 0:
            continue
        plane = planes[f]
        w = plane[2, 0] * ray_x + plane[2, 1] * ray_y + plane[2, 2]
        if w <= best_inverse_z:
            continue
        u = plane[0, 0] * ray_x + plane[0, 1] * ray_y + plane[0, 2]
        v = plane[1, 0] * ray_x + plane[1, 1] * ray_y + plane[1, 2]
        if 0.0 <= u <= w * levels[f, 0, 1] and 0.0 <= v <= w * levels[f, 0, 2]:
            best, best_inverse_z = f, w
    return best


@njit(cache=True, nogil=True)
def _footprint(
    plane: NDArray[np.float64], u: float, v: float, z: float, step_x: float, step_y: float
) -> tuple[int, int, float, float, float, float]:
    """Samples, finer mip level, weights of a sample there and one level up, and the step between samples.

    Samples line up along the longer axis of the pixel's image in the texture; the level fits the width of one sample.
    """
    ux, vx = (plane[0, 0] - u * plane[2, 0]) * z * step_x, (plane[1, 0] - v * plane[2, 0]) * z * step_x
    uy, vy = (plane[0, 1] - u * plane[2, 1]) * z * step_y, (plane[1, 1] - v * plane[2, 1]) * z * step_y
    along_x, along_y = ux * ux + vx * vx, uy * uy + vy * vy
    if along_x > along_y:
        long_u, long_v, long, short = ux, vx, np.sqrt(along_x), np.sqrt(along_y)
    else:
        long_u, long_v, long, short = uy, vy, np.sqrt(along_y), np.sqrt(along_x)
    samples = min(max(int(long / max(short, 1e-9) + 0.75), 1), MAX_SAMPLES)
    level = min(np.log2(long / samples), LEVELS - 1.001) if long > samples else 0.0
    low = int(level)
    # Only the middle half between two levels is blended: one level alone is half the work.
    up = min(max(2.0 * (level - low) - 0.5, 0.0), 1.0)
    weight_up = np.floor(up * _ONE / samples)
    return samples, low, np.floor(_ONE / samples) - weight_up, weight_up, long_u / samples, long_v / samples


@njit(cache=True, nogil=True)
def _filtered(
    texels: NDArray[np.uint32],
    levels: NDArray[np.int64],
    footprint: tuple[int, int, float, float, float, float],
    u: float,
    v: float,
) -> tuple[float, float, float]:
    """Blue, green, red of a footprint about (u, v), texels of level 0."""
    samples, low, weight_low, weight_up, du, dv = footprint
    u -= 0.5 * (samples - 1) * du
    v -= 0.5 * (samples - 1) * dv
    scale = 1.0 / (1 << low)
    total = np.uint64(0)
    for _ in range(samples):
        if weight_low > 0.0:
            total += _bilinear(texels, levels[low], u * scale, v * scale, weight_low)
        if weight_up > 0.0:
            total += _bilinear(texels, levels[low + 1], 0.5 * u * scale, 0.5 * v * scale, weight_up)
        u += du
        v += dv
    share = 1.0 / (samples * (weight_low + weight_up))
    mask = np.uint64((1 << _LANE) - 1)
    return (
        (total & mask) * share,
        ((total >> np.uint64(_LANE)) & mask) * share,
        (total >> np.uint64(2 * _LANE)) * share,
    )


@njit(cache=True, nogil=True)
def _bilinear(texels: NDArray[np.uint32], level: NDArray[np.int64], u: float, v: float, weight: float) -> np.uint64:
    """Weighted sum of four texels with each channel in a lane of its own; texel centres are at halves."""
    at, width, height = level[0], level[1], level[2]
    x = min(max(u - 0.5, 0.0), width - 1.000001)
    y = min(max(v - 0.5, 0.0), height - 1.000001)
    column, row = int(x), int(y)
    low = weight * (y - row)
    top = weight - low
    w01, w11 = np.int64(top * (x - column)), np.int64(low * (x - column))
    w00 = np.int64(top) - w01
    w10 = np.int64(weight) - w00 - w01 - w11
    first = np.uint64(at + row * width + column)
    second = first + np.uint64(width)
    return (
        _lanes(texels[first]) * np.uint64(w00)
        + _lanes(texels[first + np.uint64(1)]) * np.uint64(w01)
        + _lanes(texels[second]) * np.uint64(w10)
        + _lanes(texels[second + np.uint64(1)]) * np.uint64(w11)
    )


@njit(cache=True, nogil=True)
def _lanes(texel: np.uint32) -> np.uint64:
    wide = np.uint64(texel)
    return (
        (wide & np.uint64(0xFF))
        | ((wide & np.uint64(0xFF00)) << np.uint64(_LANE - 8))
        | ((wide & np.uint64(0xFF0000)) << np.uint64(2 * _LANE - 16))
    )
