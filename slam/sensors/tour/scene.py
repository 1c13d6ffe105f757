"""The furnished flat as arrays, painted and lit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from slam.sensors.tour.atlas import MULTIPLE, Atlas, make_atlas
from slam.sensors.tour.face import Face
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
    light = Light(plan)
    textures = []
    for row, face in enumerate(plan.faces):
        texture = _painted(face, np.random.default_rng([_SEED, row]))
        textures.append(texture if face.glows else light.apply(face, texture))
    origins, rights, downs = (
        np.array([getattr(face, name) for face in plan.faces], float) for name in ("origin", "right", "down")
    )
    return Scene(origins, rights, downs, make_atlas(textures))


def _painted(face: Face, rng: np.random.Generator) -> NDArray[np.uint8]:
    width, height = float(np.linalg.norm(face.right)), float(np.linalg.norm(face.down))
    rows, columns = (max(1, round(side * face.pixels_per_m / MULTIPLE)) * MULTIPLE for side in (height, width))
    canvas = Canvas(np.zeros((rows, columns, 3), np.uint8), width, height, rng)
    face.paint(canvas)
    return canvas.image
