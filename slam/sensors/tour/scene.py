"""The furnished flat as arrays, painted and lit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from slam.sensors.tour.atlas import Atlas, make_atlas, texture_size
from slam.sensors.tour.face import Face, Plan
from slam.sensors.tour.light import Light
from slam.sensors.tour.paint.canvas import Canvas
from slam.sensors.tour.rooms import furnish

_SEED = 2024


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Faces as arrays: top left corner, right edge and down edge (F, 3) in the world, and their textures."""

    origins: NDArray[np.float64]
    rights: NDArray[np.float64]
    downs: NDArray[np.float64]
    atlas: Atlas


@cache
def load_scene() -> Scene:
    """The one scene of the tour, painted and lit once in a process."""
    plan = furnish()
    origins, rights, downs = (
        np.array([getattr(face, name) for face in plan.faces], float) for name in ("origin", "right", "down")
    )
    sizes = [texture_size(*(side * face.pixels_per_m for side in _sides(face))) for face in plan.faces]
    return Scene(origins, rights, downs, make_atlas(sizes, _textures(plan, sizes)))


def _textures(plan: Plan, sizes: list[tuple[int, int]]) -> Iterator[NDArray[np.uint8]]:
    light = Light(plan)
    for row, (face, (columns, rows)) in enumerate(zip(plan.faces, sizes, strict=True)):
        canvas = Canvas(np.zeros((rows, columns, 3), np.uint8), *_sides(face), np.random.default_rng([_SEED, row]))
        face.paint(canvas)
        if not face.glows:
            light.shine(face, canvas.image)
        yield canvas.image


def _sides(face: Face) -> tuple[float, float]:
    return float(np.linalg.norm(face.right)), float(np.linalg.norm(face.down))
