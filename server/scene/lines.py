"""Straight pieces of line in one colour, in a few scene nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.tone import Rgb, for_line

if TYPE_CHECKING:
    from viser import LineSegmentsHandle, SceneApi

Segments = NDArray[np.float64]

#: Segments of one scene node: a map that grows, or whose past somebody goes through, sends only the last piece again.
PIECE = 512


class Lines:
    """Line segments of one colour and one thickness in pixels; what did not change or is not to be seen is not sent."""

    def __init__(self, scene: SceneApi, name: str, thickness_px: float) -> None:
        self._scene = scene
        self._name = name
        self._thickness = thickness_px
        self._pieces: list[LineSegmentsHandle] = []

    def draw(self, segments: Segments, rgb: Rgb, *, visible: bool = True) -> None:
        """Show segments (S, 2, 3), map frame."""
        for piece in self._pieces:
            piece.visible = visible
        if not visible:
            return
        colour = np.array(for_line(rgb), dtype=np.uint8)
        wanted = -(-len(segments) // PIECE)
        for number in range(wanted):
            part = segments[number * PIECE : (number + 1) * PIECE].astype(np.float32)
            if number < len(self._pieces):
                self._pieces[number].points = part
                self._pieces[number].colors = colour
            else:
                self._pieces.append(self._make(number, part, colour))
        for gone in self._pieces[wanted:]:
            gone.remove()
        del self._pieces[wanted:]

    def _make(self, number: int, part: NDArray[np.float32], colour: NDArray[np.uint8]) -> LineSegmentsHandle:
        return self._scene.add_line_segments(
            f"{self._name}/{number}", part, colour, thickness=self._thickness, thickness_units="screen"
        )


def chain(points: NDArray[np.float64]) -> Segments:
    """Segments (N - 1, 2, 3) that join points (N, 3) one after the other."""
    return np.stack([points[:-1], points[1:]], axis=1)


def dashed(points: NDArray[np.float64], dash_m: float, most: int = 3000) -> Segments:
    """The path through points (N, 3) as dashes with gaps of the same length; longer ones where it would be too many.

    Dashes are counted from the start, so that a path that grows keeps those it has.
    """
    if len(points) < 2:
        return np.zeros((0, 2, 3))
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    length = float(way[-1])
    while length > 2.0 * dash_m * most:
        dash_m *= 2.0
    starts = np.arange(0.0, length, 2.0 * dash_m)
    ends = np.minimum(starts + dash_m, length)
    return np.stack([_at(starts, way, points), _at(ends, way, points)], axis=1)


def _at(places: NDArray[np.float64], way: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.column_stack([np.interp(places, way, points[:, axis]) for axis in range(3)])
