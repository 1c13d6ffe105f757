"""Which colour to send so that the browser shows the wanted one.

viser's page maps tones as three.js does by default (Stephen Hill's fit of the ACES curve, exposure 1), which turns
pure colours pale; clouds and images are left alone. It also takes the colours of batched meshes for linear light.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]
Array = NDArray[np.float64]

_INTO = np.array([[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]])
_OUT_OF = np.array([[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]])
_EXPOSURE = 1.0 / 0.6
#: The brightest grey that can be shown, a little less.
_GREY = 0.85
_SHARES = np.linspace(0.0, 1.0, 21)[:, None, None]
_TOLERANCE = 0.02
#: Makes one number of a colour.
_CODE = np.array([65536, 256, 1])


@lru_cache(maxsize=256)
def for_line(rgb: Rgb) -> Rgb:
    """What lines, frusta, plain meshes and the ground grid must be given to look like ``rgb``."""
    r, g, b = np.rint(_encoded(_scene_light(np.array([rgb]) / 255.0))[0] * 255.0).astype(int).tolist()
    return r, g, b


def for_batch(colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """What the instances of a batched mesh must be given to look like ``colours`` (N, 3)."""
    codes, which = np.unique(colours.reshape(-1, 3) @ _CODE, return_inverse=True)
    distinct = (codes[:, None] // _CODE) % 256
    light = np.rint(_scene_light(distinct / 255.0) * 255.0).astype(np.uint8)
    return np.asarray(light[which.reshape(-1)])


def _scene_light(srgb: Array) -> Array:
    """Linear light (N, 3) from 0 to 1 before tone mapping that comes out as sRGB values (N, 3).

    No light comes out as pure or bright as some colours: those get as much grey as it takes, which keeps their hue.
    """
    grey = np.minimum(srgb.mean(axis=1, keepdims=True), _GREY)
    tried = srgb[None] * (1.0 - _SHARES) + grey[None] * _SHARES
    light = _before_mapping(_decoded(tried))
    possible = (light > -_TOLERANCE).all(axis=2) & (light < 1.0 + _TOLERANCE).all(axis=2)
    # The last is grey alone, which is always possible.
    least = np.where(possible.any(axis=0), possible.argmax(axis=0), len(_SHARES) - 1)
    return np.asarray(light[least, np.arange(len(srgb))].clip(0.0, 1.0))


def _before_mapping(shown: Array) -> Array:
    """Linear light (..., 3) that the tone mapping turns into ``shown``; outside of 0 to 1 where there is none."""
    fitted = (shown @ np.linalg.inv(_OUT_OF).T).clip(0.0, 0.98)
    # fit(v) = (v (v + a) - b) / (v (c v + d) + e) = y, solved for v.
    a, b, c, d, e = 0.0245786, 0.000090537, 0.983729, 0.4329510, 0.238081
    A, B, C = 1.0 - c * fitted, a - d * fitted, -(b + e * fitted)
    light = (-B + np.sqrt(B * B - 4.0 * A * C)) / (2.0 * A)
    return np.asarray(light @ np.linalg.inv(_INTO).T / _EXPOSURE)


def _decoded(srgb: Array) -> Array:
    """Linear light of sRGB values from 0 to 1 (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _encoded(light: Array) -> Array:
    """sRGB values of linear light, both from 0 to 1."""
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
