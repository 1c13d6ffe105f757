"""Scans of made-up surfaces: the corner of a room, a corridor, a wall."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.features.words import nothing_seen
from slam.geometry import Pose, inverse, transform
from slam.registration.view import View
from slam.types import Scan
from tests.nodes import CAMERA

Array = NDArray[np.float64]
#: Middle, and both half sides, of each rectangle in the world, metres.
WALL = (((3.0, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, 0.0, 1.0)),)
CORRIDOR = (
    ((2.0, 1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ((2.0, -1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ((2.0, 0.0, -1.0), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
)
CORNER = (
    *WALL,
    ((1.5, 1.5, 0.0), (1.5, 0.0, 0.0), (0.0, 0.0, 1.0)),
    ((1.5, 0.0, -1.0), (1.5, 0.0, 0.0), (0.0, 1.5, 0.0)),
)


def scan(
    surfaces: tuple[tuple[tuple[float, ...], ...], ...], T_world_base: Pose, seed: int, noise: float = 0.003
) -> Scan:
    """Random points of the surfaces, seen from a pose, 900 on each."""
    rng = np.random.default_rng(seed)
    points = []
    for middle, along, up in surfaces:
        a, b = rng.uniform(-1, 1, (2, 900, 1))
        points.append(np.array(middle) + a * np.array(along) + b * np.array(up))
    world = np.concatenate(points) + rng.normal(size=(900 * len(surfaces), 3)) * noise
    return Scan(transform(inverse(T_world_base), world).astype(np.float32))


def view(cloud: Scan | None) -> View:
    """A view of which only the cloud is known."""
    return View(nothing_seen(), CAMERA, cloud)
