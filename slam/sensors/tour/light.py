"""Baked light: lamps, windows and what reaches the corners."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.sensors.tour.face import Face, Plan
from slam.sensors.tour.paint.canvas import STRIP_ROWS
from slam.sensors.tour.rooms import DEPTH, HEIGHT, LAMPS, SILL, WIDTH, WINDOW_SIZE, WINDOWS

#: Distance between points where the light is worked out, in metres.
SPACING_M = 0.2
#: Walls and blocks nearer than this take away from the light that comes from everywhere.
REACH_M = 1.6
#: Blue, green, red of lamps, windows and of the light that comes from everywhere.
_LAMP, _SKY, _AMBIENT = (0.86, 0.97, 1.05), (1.25, 1.10, 0.98), (0.66, 0.68, 0.70)
_DIRECTIONS = 16


class Light:
    """Light at points of the scene."""

    def __init__(self, plan: Plan) -> None:
        self._blocks = np.array([(*low, *high) for low, high in plan.blocks])
        sources = [((x + dx, y, HEIGHT), (0, 0, -1), _LAMP, 0.55) for x, y in LAMPS for dx in (-0.3, 0.3)]
        sill, across = SILL + WINDOW_SIZE[1] / 2, WINDOW_SIZE[0]
        sources += [((x + f * across, DEPTH, sill), (0, -1, 0), _SKY, 1.1) for x in WINDOWS for f in (0.2, 0.5, 0.8)]
        self._places = np.array([place for place, _, _, _ in sources], float)
        self._axes = np.array([axis for _, axis, _, _ in sources], float)
        self._colors = np.array([np.array(color) * power for _, _, color, power in sources])

    def on(self, face: Face) -> NDArray[np.float32]:
        """Light (rows, columns, 3) on a face, about one where it is well lit; row 0 is at its top."""
        right, down = np.array(face.right), np.array(face.down)
        columns, rows = (max(2, round(float(np.linalg.norm(edge)) / SPACING_M)) for edge in (right, down))
        normal = -np.cross(right, down)
        normal /= np.linalg.norm(normal)
        u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
        points = np.array(face.origin) + u.reshape(-1, 1) * right + v.reshape(-1, 1) * down + 0.01 * normal
        out = np.zeros((rows * columns, 3))
        _add_ambient(points, _hemisphere(normal), self._blocks, np.array([WIDTH, DEPTH, HEIGHT]), out)
        _add_direct(points, normal, self._blocks, self._places, self._axes, self._colors, out)
        return out.reshape(rows, columns, 3).astype(np.float32)

    def shine(self, face: Face, texture: NDArray[np.uint8]) -> None:
        """Make a face's texture (H, W, 3) look as it does in this light."""
        coarse = self.on(face)
        height, width = texture.shape[:2]
        # First along the rows, then strip by strip: the light of a whole floor would take more memory than its texture.
        wide = cv2.resize(coarse, (width, len(coarse)), interpolation=cv2.INTER_LINEAR)
        at = np.clip((np.arange(height) + 0.5) * len(coarse) / height - 0.5, 0, len(coarse) - 1)
        for first in range(0, height, STRIP_ROWS):
            rows = slice(first, first + STRIP_ROWS)
            low = np.minimum(at[rows].astype(int), len(coarse) - 2)
            share = (at[rows] - low).astype(np.float32)[:, None, None]
            light = wide[low] * (1 - share) + wide[low + 1] * share
            texture[rows] = np.clip(texture[rows] * light, 0, 255).astype(np.uint8)


def _hemisphere(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Directions (D, 3) about a normal, denser towards it by the cosine (Fibonacci spiral on the disc)."""
    k = np.arange(_DIRECTIONS) + 0.5
    radius, angle = np.sqrt(k / _DIRECTIONS), k * np.pi * (3.0 - np.sqrt(5.0))
    side = np.array([0.0, 1.0, 0.0]) if abs(normal[0]) > 0.5 else np.array([1.0, 0.0, 0.0])
    x = np.cross(side, normal)
    y = np.cross(normal, x)
    local = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - radius**2)])
    return np.asarray(local @ np.array([x, y, normal]))


@njit(cache=True, nogil=True)
def _hit(
    start: NDArray[np.float64], way: NDArray[np.float64], blocks: NDArray[np.float64], limit: float, nearest: bool
) -> float:
    """Distance along ``way`` to a block, at most ``limit``; to any block unless ``nearest`` (slab method)."""
    best = limit
    ix, iy, iz = 1.0 / (way[0] + 1e-12), 1.0 / (way[1] + 1e-12), 1.0 / (way[2] + 1e-12)
    for i in range(len(blocks)):
        ax, bx = (blocks[i, 0] - start[0]) * ix, (blocks[i, 3] - start[0]) * ix
        ay, by = (blocks[i, 1] - start[1]) * iy, (blocks[i, 4] - start[1]) * iy
        az, bz = (blocks[i, 2] - start[2]) * iz, (blocks[i, 5] - start[2]) * iz
        near = max(min(ax, bx), min(ay, by), min(az, bz), 0.0)
        far = min(max(ax, bx), max(ay, by), max(az, bz), best)
        if near < far:
            best = near
            if not nearest:
                break
    return best


@njit(cache=True, nogil=True)
def _add_ambient(
    points: NDArray[np.float64],
    directions: NDArray[np.float64],
    blocks: NDArray[np.float64],
    room: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Add the light that comes from everywhere, by how far one sees from each point in directions (D, 3)."""
    for p in range(len(points)):
        seen = 0.0
        for d in range(len(directions)):
            way = directions[d]
            limit = REACH_M
            for axis in range(3):
                if way[axis] > 1e-9:
                    limit = min(limit, (room[axis] - points[p, axis]) / way[axis])
                elif way[axis] < -1e-9:
                    limit = min(limit, -points[p, axis] / way[axis])
            seen += _hit(points[p], way, blocks, limit, True) / REACH_M
        for c in range(3):
            out[p, c] += _AMBIENT[c] * (0.30 + 0.70 * seen / len(directions))


@njit(cache=True, nogil=True)
def _add_direct(
    points: NDArray[np.float64],
    normal: NDArray[np.float64],
    blocks: NDArray[np.float64],
    places: NDArray[np.float64],
    axes: NDArray[np.float64],
    colors: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Add the light of every source (S, 3) that shines on a point and is not hidden by a block."""
    for p in range(len(points)):
        for i in range(len(places)):
            way = places[i] - points[p]
            distance = np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2)
            way = way / distance
            facing = way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]
            shining = -(way[0] * axes[i, 0] + way[1] * axes[i, 1] + way[2] * axes[i, 2])
            if facing <= 0.0 or shining <= 0.0:
                continue
            reach = distance - 0.02
            if _hit(points[p], way, blocks, reach, False) >= reach:
                strength = facing * shining / (0.35 + distance * distance)
                for c in range(3):
                    out[p, c] += colors[i, c] * strength
