"""All textures of the scene in one array, each at several resolutions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

#: Full size, half, a quarter, ...: sizes are multiples of 2 ** (LEVELS - 1), so that levels fit exactly.
LEVELS = 6
MULTIPLE = 2 ** (LEVELS - 1)


@dataclass(frozen=True, slots=True, eq=False)
class Atlas:
    """Mip maps of F textures.

    Attributes:
        texels: flat uint32 0x00RRGGBB, row by row.
        levels: (F, LEVELS, 3) int64 offset into texels, width, height.
    """

    texels: NDArray[np.uint32]
    levels: NDArray[np.int64]


def texture_size(width_px: float, height_px: float) -> tuple[int, int]:
    """Width and height of a texture of about this size that all levels fit."""
    width, height = (max(1, round(side / MULTIPLE)) * MULTIPLE for side in (width_px, height_px))
    return width, height


def make_atlas(sizes: Sequence[tuple[int, int]], textures: Iterable[NDArray[np.uint8]]) -> Atlas:
    """Atlas of textures (H, W, 3) uint8, blue green red, whose widths and heights come from ``texture_size``.

    Textures are taken one at a time, so that an iterable that makes them needs memory for one.
    """
    levels = np.zeros((len(sizes), LEVELS, 3), np.int64)
    levels[:, :, 1:] = np.array(sizes)[:, None] >> np.arange(LEVELS)[None, :, None]
    counts = levels[..., 1] * levels[..., 2]
    levels[..., 0] = (np.cumsum(counts) - counts.ravel()).reshape(counts.shape)
    texels = np.zeros((int(counts.sum()), 4), np.uint8)
    for row, texture in enumerate(textures):
        image = texture
        for level, (offset, width, height) in enumerate(levels[row].tolist()):
            if level:
                image = np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
            texels[offset : offset + width * height, :3] = image.reshape(-1, 3)
    return Atlas(texels.view("<u4").reshape(-1).astype(np.uint32, copy=False), levels)
