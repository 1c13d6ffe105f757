"""The flat: faces in the world with their textures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from slam.sensors.tour.atlas import MULTIPLE, Atlas, make_atlas

Image = NDArray[np.uint8]
Painter = Callable[[int, int, np.random.Generator], Image]
WIDTH_M, DEPTH_M, HEIGHT_M = 14.0, 10.0, 2.7
PIXELS_PER_M = 160


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A textured rectangle seen from its front: top left corner, edge to the right, edge downwards, in metres."""

    origin: tuple[float, float, float]
    right: tuple[float, float, float]
    down: tuple[float, float, float]
    paint: Painter


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Faces as arrays: corner, right edge and down edge (F, 3) in the world, and their textures."""

    origins: NDArray[np.float64]
    rights: NDArray[np.float64]
    downs: NDArray[np.float64]
    atlas: Atlas


@cache
def load_scene() -> Scene:
    """The one scene of the tour, painted once in a process."""
    faces = list(_faces())
    textures = [_texture(face, np.random.default_rng([7, row])) for row, face in enumerate(faces)]
    vectors = [np.array([getattr(face, name) for face in faces]) for name in ("origin", "right", "down")]
    return Scene(vectors[0], vectors[1], vectors[2], make_atlas(textures))


def _texture(face: Face, rng: np.random.Generator) -> Image:
    sides = [np.linalg.norm(edge) * PIXELS_PER_M for edge in (face.down, face.right)]
    height, width = (max(1, round(float(side) / MULTIPLE)) * MULTIPLE for side in sides)
    return face.paint(height, width, rng)


def box(x: float, y: float, z: float, dx: float, dy: float, dz: float, paint: Painter) -> list[Face]:
    """Five outward faces (no bottom) of a box from its lower corner and its size in metres."""
    top = z + dz
    return [
        Face((x, y, top), (dx, 0, 0), (0, 0, -dz), paint),
        Face((x + dx, y, top), (0, dy, 0), (0, 0, -dz), paint),
        Face((x + dx, y + dy, top), (-dx, 0, 0), (0, 0, -dz), paint),
        Face((x, y + dy, top), (0, -dy, 0), (0, 0, -dz), paint),
        Face((x, y + dy, top), (dx, 0, 0), (0, -dy, 0), paint),
    ]


def _faces() -> list[Face]:
    w, d, h = WIDTH_M, DEPTH_M, HEIGHT_M
    faces = [
        Face((0, 0, 0), (0, d, 0), (w, 0, 0), busy),
        Face((0, 0, h), (w, 0, 0), (0, d, 0), busy),
        Face((w, 0, h), (-w, 0, 0), (0, 0, -h), busy),
        Face((0, d, h), (w, 0, 0), (0, 0, -h), busy),
        Face((0, 0, h), (0, d, 0), (0, 0, -h), busy),
        Face((w, d, h), (0, -d, 0), (0, 0, -h), busy),
    ]
    faces += box(3.0, 2.6, 0, 8.0, 0.15, h, busy)
    faces += box(3.2, 4.0, 0, 2.0, 0.9, 0.75, busy)
    faces += box(7.0, 5.0, 0, 2.4, 1.0, 1.5, busy)
    faces += box(4.5, 9.4, 0, 2.4, 0.6, 1.9, busy)
    faces += box(9.5, 6.0, 0, 0.5, 0.5, h, busy)
    return faces


def busy(height: int, width: int, rng: np.random.Generator) -> Image:
    """A wall with many coloured panels."""
    image = np.full((height, width, 3), rng.integers(140, 220, 3), np.uint8)
    for _ in range(height * width // 2500 + 4):
        x, y = int(rng.integers(0, width)), int(rng.integers(0, height))
        dx, dy = (int(v) for v in rng.integers(6, 60, 2))
        color = tuple(int(v) for v in rng.integers(20, 240, 3))
        cv2.rectangle(image, (x, y), (x + dx, y + dy), color, -1)
    return image
