"""All textures of the scene in one array, each at several resolutions."""

from __future__ import annotations

from collections.abc import Sequence
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


def make_atlas(textures: Sequence[NDArray[np.uint8]]) -> Atlas:
    """Atlas of textures (H, W, 3) uint8, blue green red, whose sides are multiples of ``MULTIPLE``."""
    parts: list[NDArray[np.uint32]] = []
    levels = np.zeros((len(textures), LEVELS, 3), np.int64)
    offset = 0
    for row, texture in enumerate(textures):
        image = texture
        for level in range(LEVELS):
            height, width = image.shape[:2]
            levels[row, level] = offset, width, height
            parts.append(_packed(image))
            offset += height * width
            if level + 1 < LEVELS:
                image = np.asarray(cv2.resize(image, (width // 2, height // 2), interpolation=cv2.INTER_AREA), np.uint8)
    return Atlas(np.concatenate(parts), levels)


def _packed(image: NDArray[np.uint8]) -> NDArray[np.uint32]:
    four = np.zeros((*image.shape[:2], 4), np.uint8)
    four[..., :3] = image
    return four.view("<u4").reshape(-1).astype(np.uint32, copy=False)
