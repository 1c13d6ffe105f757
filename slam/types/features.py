"""Key points of one image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Descriptors (N, B): uint8 holds B bytes of bits, compared by Hamming distance; float32 holds B numbers, by L2.
Descriptors = NDArray[np.uint8] | NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Features:
    """Key points of one image with descriptors and depth; row i of each array is the same key point.

    Attributes:
        pixels: (N, 2) float32, x then y.
        sizes: (N,) float32 diameter in pixels.
        angles: (N,) float32 degrees, -1 where the detector gives none.
        responses: (N,) float32 detector score.
        octaves: (N,) int32.
        descriptors: (N, B) uint8 for binary descriptors of B bytes, or float32.
        points_base: (N, 3) float32 in the base frame, metres, NaN where there is no depth.
    """

    pixels: NDArray[np.float32]
    sizes: NDArray[np.float32]
    angles: NDArray[np.float32]
    responses: NDArray[np.float32]
    octaves: NDArray[np.int32]
    descriptors: Descriptors
    points_base: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.pixels)

    def take(self, rows: NDArray[np.integer] | NDArray[np.bool_]) -> Features:
        """The features of these rows, in this order."""
        return Features(
            self.pixels[rows],
            self.sizes[rows],
            self.angles[rows],
            self.responses[rows],
            self.octaves[rows],
            self.descriptors[rows],
            self.points_base[rows],
        )
