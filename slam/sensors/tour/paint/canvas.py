"""A surface to paint on, measured in metres."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

#: Blue, green, red.
Color = tuple[int, int, int]
Painter = Callable[["Canvas"], None]
#: Sub-pixel bits of OpenCV's drawing functions.
_SHIFT = 4
#: Large surfaces are worked on in strips of this many rows, to save memory.
STRIP_ROWS = 128


def rgb(code: int) -> Color:
    """Colour of a web code such as 0xC2703D."""
    return code & 255, code >> 8 & 255, code >> 16


class Canvas:
    """Drawing on an image (H, W, 3) uint8 with x to the right and y down, in metres from its top left corner."""

    def __init__(self, image: NDArray[np.uint8], width: float, height: float, rng: np.random.Generator) -> None:
        self.image = image
        self.width = width
        self.height = height
        self.rng = rng
        self._scale = np.array([image.shape[1] / width, image.shape[0] / height])

    def part(self, x: float, y: float, width: float, height: float) -> Canvas:
        """A rectangle of this canvas as a canvas of its own; it shares the pixels."""
        low = np.maximum(np.rint(np.array([x, y]) * self._scale), 0).astype(int)
        high = np.maximum(np.rint(np.array([x + width, y + height]) * self._scale).astype(int), low + 1)
        image = self.image[low[1] : high[1], low[0] : high[0]]
        low = np.minimum(low, [self.image.shape[1] - 1, self.image.shape[0] - 1])
        image = image if image.size else self.image[low[1] : low[1] + 1, low[0] : low[0] + 1]
        return Canvas(image, width, height, self.rng)

    def fill(self, color: Color) -> None:
        """One colour everywhere."""
        self.image[:] = color

    def rect(self, x: float, y: float, width: float, height: float, color: Color) -> None:
        """A filled rectangle."""
        self.part(x, y, width, height).fill(color)

    def frame(self, thickness: float, color: Color) -> None:
        """A border inside the canvas' edge."""
        self.rect(0, 0, self.width, thickness, color)
        self.rect(0, self.height - thickness, self.width, thickness, color)
        self.rect(0, 0, thickness, self.height, color)
        self.rect(self.width - thickness, 0, thickness, self.height, color)

    def polygon(self, points: Sequence[tuple[float, float]] | NDArray[np.float64], color: Color) -> None:
        """A filled polygon with smooth edges."""
        cv2.fillPoly(self.image, [self._fixed(points)], color, cv2.LINE_AA, _SHIFT)

    def line(
        self, points: Sequence[tuple[float, float]] | NDArray[np.float64], color: Color, thickness: float = 0.006
    ) -> None:
        """An open line through points."""
        width = max(1, round(thickness * float(self._scale.mean())))
        cv2.polylines(self.image, [self._fixed(points)], False, color, width, cv2.LINE_AA, _SHIFT)

    def disc(self, x: float, y: float, radius: float, color: Color, start: float = 0.0, end: float = 360.0) -> None:
        """A filled circle, or its sector between two angles in degrees."""
        angles = np.radians(np.linspace(start, end, 40))
        arc = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
        whole = end - start >= 360.0
        self.polygon(arc if whole else np.vstack([arc, [[x, y]]]), color)

    def text(self, x: float, y: float, height: float, text: str, color: Color, weight: float = 0.12) -> None:
        """Capital letters of this height with their base line at y."""
        size = height * float(self._scale[1]) / 22.0
        at = np.rint(np.array([x, y]) * self._scale).astype(int)
        width = max(1, round(weight * height * float(self._scale[1])))
        cv2.putText(
            self.image, text, (int(at[0]), int(at[1])), cv2.FONT_HERSHEY_DUPLEX, size, color, width, cv2.LINE_AA
        )

    def noise(self, cell_x: float, cell_y: float) -> NDArray[np.float32]:
        """Smooth random field (H, W) of deviation about one, with features of this size."""
        height, width = self.image.shape[:2]
        columns = max(2, int(np.ceil(self.width / cell_x)) + 1)
        rows = max(2, int(np.ceil(self.height / cell_y)) + 1)
        coarse = self.rng.standard_normal((min(rows, 4 * height), min(columns, 4 * width)), np.float32)
        return np.asarray(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC), np.float32)

    def tint(self, field: NDArray[np.float32]) -> None:
        """Make brighter by a field (H, W) of fractions; negative ones darken."""
        for first in range(0, len(field), STRIP_ROWS):
            rows = slice(first, first + STRIP_ROWS)
            self.image[rows] = np.clip(self.image[rows] * (1 + field[rows, :, None]), 0, 255).astype(np.uint8)

    def pick(self, colors: Sequence[Color]) -> Color:
        """One of these colours."""
        return colors[int(self.rng.integers(len(colors)))]

    def vary(self, color: Color, amount: float) -> Color:
        """A colour made brighter or darker by up to this fraction."""
        factor = 1.0 + float(self.rng.uniform(-amount, amount))
        b, g, r = (min(255, int(channel * factor)) for channel in color)
        return b, g, r

    def _fixed(self, points: Sequence[tuple[float, float]] | NDArray[np.float64]) -> NDArray[np.int32]:
        pixels = np.asarray(points, np.float64) * self._scale - 0.5
        return np.asarray(np.rint(pixels * (1 << _SHIFT)), np.int32)
