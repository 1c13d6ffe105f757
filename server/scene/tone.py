"""Which colour to send so that the browser shows the wanted one.

viser's page maps tones as three.js does by default (Stephen Hill's fit of the ACES curve, exposure 1), which turns
pure colours pale; clouds and images are left alone. It also takes the colours of batched meshes for linear light.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]
Array = NDArray[np.float64]

_INTO = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_OUT_OF = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
_EXPOSURE = 1.0 / 0.6


def for_line(rgb: Rgb) -> Rgb:
    """What lines, frusta, plain meshes and the ground grid must be given to look like ``rgb``."""
    r, g, b = np.rint(_encoded(_scene_light(_decoded(np.array(rgb) / 255.0))) * 255.0).astype(int).tolist()
    return r, g, b


def for_batch(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """What the instances of a batched mesh must be given to look like ``colours`` (N, 3)."""
    light = _scene_light(_decoded(colours / 255.0))
    return np.asarray(np.rint(light * 255.0), dtype=np.uint8)


def _scene_light(shown: Array) -> Array:
    """Linear light (..., 3) before tone mapping that comes out as ``shown``; the nearest there is, within 0 to 1."""
    fitted = (shown @ np.linalg.inv(_OUT_OF).T).clip(0.0, 0.98)
    # fit(v) = (v (v + a) - b) / (v (c v + d) + e) = y, solved for v.
    a, b, c, d, e = 0.0245786, 0.000090537, 0.983729, 0.4329510, 0.238081
    A, B, C = 1.0 - c * fitted, a - d * fitted, -(b + e * fitted)
    light = (-B + np.sqrt(B * B - 4.0 * A * C)) / (2.0 * A)
    return np.asarray((light @ np.linalg.inv(_INTO).T / _EXPOSURE).clip(0.0, 1.0))


def _decoded(srgb: Array) -> Array:
    """Linear light of sRGB values from 0 to 1 (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _encoded(light: Array) -> Array:
    """sRGB values of linear light, both from 0 to 1."""
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
