"""SURF's blobs: maxima of the Hessian's determinant over place and scale, by box filters (Bay 2008)."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: The mixed derivative's box is coarser than the Gaussian it stands for.
_MIXED = 0.9


def blobs(gray: NDArray[np.uint8], *, octaves: int, layers: int, threshold: float) -> Floats:
    """Rows x, y, side of the filter in pixels, response, sign of the Laplacian; in no order.

    Args:
        gray: (H, W).
        octaves: each twice as coarse as the one before.
        layers: scales of an octave at which a blob may be.
        threshold: least determinant, in squared grey levels.
    """
    integral = np.asarray(cv2.integral(gray, sdepth=cv2.CV_64F), np.float64)
    parts = []
    for octave in range(octaves):
        lobes = [2 ** (octave + 1) * (layer + 1) + 1 for layer in range(layers + 2)]
        step = 2**octave
        stack = np.stack([_determinants(integral, lobe, step) for lobe in lobes])
        parts.append(_maxima(stack, step, 3.0 * lobes[0], 3.0 * (lobes[1] - lobes[0]), threshold))
    found = np.concatenate(parts)
    found[:, 4] = _laplacian_signs(integral, found)
    return found


@njit(cache=True, nogil=True)
def _box(integral: Floats, y: int, x: int, height: int, width: int) -> float:
    """Sum of the pixels from (y, x) on."""
    return float(integral[y + height, x + width] - integral[y, x + width] - integral[y + height, x] + integral[y, x])


@njit(cache=True, nogil=True)
def _second_derivatives(integral: Floats, y: int, x: int, lobe: int) -> tuple[float, float, float]:
    """Second derivatives along x, along y and mixed, at a pixel; the filter's side is three lobes."""
    half, long = lobe // 2, 2 * lobe - 1
    area = float(lobe * long)
    start = half + lobe
    across = _box(integral, y - lobe + 1, x - start, long, 3 * lobe) - 3.0 * _box(
        integral, y - lobe + 1, x - half, long, lobe
    )
    down = _box(integral, y - start, x - lobe + 1, 3 * lobe, long) - 3.0 * _box(
        integral, y - half, x - lobe + 1, lobe, long
    )
    mixed = (
        _box(integral, y - lobe, x - lobe, lobe, lobe)
        + _box(integral, y + 1, x + 1, lobe, lobe)
        - _box(integral, y - lobe, x + 1, lobe, lobe)
        - _box(integral, y + 1, x - lobe, lobe, lobe)
    )
    return across / area, down / area, mixed / float(lobe * lobe)


@njit(cache=True, nogil=True)
def _determinants(integral: Floats, lobe: int, step: int) -> NDArray[np.float32]:
    """Determinant at every ``step``-th pixel; 0 where the filter does not fit."""
    height, width = integral.shape[0] - 1, integral.shape[1] - 1
    margin = lobe + lobe // 2 + 1
    found = np.zeros(((height + step - 1) // step, (width + step - 1) // step), np.float32)
    for i in range(found.shape[0]):
        y = i * step
        if y < margin or y >= height - margin:
            continue
        for j in range(found.shape[1]):
            x = j * step
            if margin <= x < width - margin:
                across, down, mixed = _second_derivatives(integral, y, x, lobe)
                found[i, j] = across * down - (_MIXED * mixed) ** 2
    return found


@njit(cache=True, nogil=True)
def _peak(before: float, middle: float, after: float) -> float:
    """Where a parabola through three values has its top, -0.5 to 0.5 of their distance."""
    curvature = before - 2.0 * middle + after
    return min(0.5, max(-0.5, 0.5 * (before - after) / curvature)) if curvature < 0.0 else 0.0


@njit(cache=True, nogil=True)
def _maxima(stack: NDArray[np.float32], step: int, first: float, growth: float, threshold: float) -> Floats:
    """Determinants that beat their 26 neighbours, placed by parabolas; ``first`` side grows by ``growth``."""
    layers, height, width = stack.shape
    found = np.empty((layers * height * width // 8 + 1, 5))
    count = 0
    for k in range(1, layers - 1):
        for i in range(1, height - 1):
            for j in range(1, width - 1):
                value = stack[k, i, j]
                if value <= threshold or value < stack[k - 1 : k + 2, i - 1 : i + 2, j - 1 : j + 2].max():
                    continue
                x = j + _peak(stack[k, i, j - 1], value, stack[k, i, j + 1])
                y = i + _peak(stack[k, i - 1, j], value, stack[k, i + 1, j])
                layer = k + _peak(stack[k - 1, i, j], value, stack[k + 1, i, j])
                found[count] = np.array([x * step, y * step, first + layer * growth, value, 0.0])
                count += 1
    return found[:count].copy()


@njit(cache=True, nogil=True)
def _laplacian_signs(integral: Floats, found: Floats) -> Floats:
    """1 for dark blobs, -1 for bright ones."""
    signs = np.empty(len(found))
    height, width = integral.shape[0] - 1, integral.shape[1] - 1
    for i in range(len(found)):
        lobe = 2 * int(found[i, 2] / 6.0) + 1
        margin = lobe + lobe // 2 + 1
        x = min(width - margin - 1, max(margin, int(np.round(found[i, 0]))))
        y = min(height - margin - 1, max(margin, int(np.round(found[i, 1]))))
        across, down, _ = _second_derivatives(integral, y, x, lobe)
        signs[i] = 1.0 if across + down > 0 else -1.0
    return signs
