"""Key points of one image, before they have descriptors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class KeyPoints:
    """Rows of the same key points: ``pixels`` (N, 2) x y, ``sizes`` (N,) pixels, ``angles`` (N,) degrees or -1,
    ``responses`` (N,), ``octaves`` (N,) as OpenCV packs them.
    """

    pixels: NDArray[np.float32]
    sizes: NDArray[np.float32]
    angles: NDArray[np.float32]
    responses: NDArray[np.float32]
    octaves: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.pixels)

    @classmethod
    def upright(cls, pixels: NDArray[np.float32], responses: NDArray[np.float32], size: float) -> KeyPoints:
        """Corners of the image as it is, without an angle."""
        count = len(pixels)
        angles = np.full(count, -1.0, np.float32)
        return cls(pixels, np.full(count, size, np.float32), angles, responses, np.zeros(count, np.int32))

    @classmethod
    def from_cv(cls, found: Sequence[cv2.KeyPoint]) -> KeyPoints:
        """What OpenCV found."""
        rows = [(*k.pt, k.size, k.angle, k.response) for k in found]
        table = np.array(rows, np.float32).reshape(-1, 5)
        octaves = np.array([k.octave for k in found], np.int64).astype(np.int32)
        return cls(np.ascontiguousarray(table[:, :2]), table[:, 2], table[:, 3], table[:, 4], octaves)

    def to_cv(self) -> list[cv2.KeyPoint]:
        """The same for OpenCV; ``class_id`` is the row."""
        columns = (*self.pixels.T, self.sizes, self.angles, self.responses, self.octaves, np.arange(len(self)))
        return list(map(cv2.KeyPoint, *(column.tolist() for column in columns)))

    def take(self, rows: NDArray[np.integer]) -> KeyPoints:
        """The key points of these rows, in this order."""
        return KeyPoints(
            self.pixels[rows], self.sizes[rows], self.angles[rows], self.responses[rows], self.octaves[rows]
        )
