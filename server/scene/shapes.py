"""Shapes that are drawn many times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A closed surface: ``vertices`` (V, 3) and ``faces`` (F, 3), counter-clockwise seen from outside."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


#: Up to so many balls are drawn with 320 and with 80 faces each, more with 20: they are seen from farther away, and
#: where there is no graphics card their faces are most of the work of a picture.
_FINE, _FAIR = 300, 1500


def ball(count: int) -> Shape:
    """A ball of radius 1 that is to be drawn so many times."""
    return icosphere(2 if count <= _FINE else 1 if count <= _FAIR else 0)


@cache
def icosphere(subdivisions: int) -> Shape:
    """A ball of radius 1: an icosahedron whose faces were cut into four so many times."""
    golden = (1.0 + 5.0**0.5) / 2.0
    ends = [(a, b * golden) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    corners = np.array([p for a, b in ends for p in ((a, b, 0.0), (0.0, a, b), (b, 0.0, a))])
    vertices = [corner / np.linalg.norm(corner) for corner in corners]
    edge = min(float(np.linalg.norm(vertices[0] - other)) for other in vertices[1:]) * 1.01
    near = [[float(np.linalg.norm(a - b)) < edge for b in vertices] for a in vertices]
    faces = [
        (i, j, k) if np.linalg.det(np.array([vertices[i], vertices[j], vertices[k]])) > 0 else (i, k, j)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i][j] and near[j][k] and near[i][k]
    ]
    for _ in range(subdivisions):
        faces = _cut(vertices, faces)
    return Shape(np.array(vertices), np.array(faces, dtype=np.int64))


def _cut(vertices: list[NDArray[np.float64]], faces: list[tuple[int, int, int]]) -> list[tuple[int, int, int]]:
    """Each face as four, the new corners pushed out to the sphere and appended to ``vertices``."""
    middles: dict[tuple[int, int], int] = {}

    def middle(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in middles:
            point = vertices[a] + vertices[b]
            middles[key] = len(vertices)
            vertices.append(point / np.linalg.norm(point))
        return middles[key]

    cut = []
    for i, j, k in faces:
        ij, jk, ki = middle(i, j), middle(j, k), middle(k, i)
        cut += [(i, ij, ki), (j, jk, ij), (k, ki, jk), (ij, jk, ki)]
    return cut
