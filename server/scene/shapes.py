"""The few bodies that are drawn many times, and the curves that they follow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Pieces of the arc of one loop link.
ARC_PIECES = 10
_CYLINDER_SIDES = 7


def sphere() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices (V, 3) and faces (F, 3) of a ball of radius 1: an icosahedron with every face cut in four."""
    golden = (1 + 5**0.5) / 2
    corners = [(x, y, 0.0) for x in (-1.0, 1.0) for y in (-golden, golden)]
    corners = corners + [(z, x, y) for x, y, z in corners] + [(y, z, x) for x, y, z in corners]
    vertices = [np.array(corner) / np.linalg.norm(corner) for corner in corners]
    edge = min(float(np.linalg.norm(vertices[0] - v)) for v in vertices[1:])
    near = np.array([[np.linalg.norm(a - b) < 1.1 * edge for b in vertices] for a in vertices])
    faces = [
        (a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]
    ]
    cut: list[tuple[int, int, int]] = []
    for a, b, c in faces:
        first = len(vertices)
        for p, q in ((a, b), (b, c), (c, a)):
            middle = vertices[p] + vertices[q]
            vertices.append(middle / np.linalg.norm(middle))
        cut += [(a, first, first + 2), (first, b, first + 1), (first + 2, first + 1, c), (first, first + 1, first + 2)]
    points = np.array(vertices)
    return points.astype(np.float32), _outward(points, np.array(cut))


def cylinder() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices and faces of a tube of radius 1 from z = 0 to z = 1, without ends."""
    angle = np.linspace(0, 2 * np.pi, _CYLINDER_SIDES, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    vertices = np.concatenate([ring, ring + np.array([0.0, 0.0, 1.0])])
    k = np.arange(_CYLINDER_SIDES)
    after = (k + 1) % _CYLINDER_SIDES
    low, high = (
        np.column_stack([k, after, k + _CYLINDER_SIDES]),
        np.column_stack([after, after + _CYLINDER_SIDES, k + _CYLINDER_SIDES]),
    )
    return vertices.astype(np.float32), np.concatenate([low, high]).astype(np.uint32)


def arcs(starts: Array, ends: Array, least_height: float) -> Array:
    """Points (N, ARC_PIECES + 1, 3) of arcs that rise from one point to the other, so that short ones are seen too."""
    share = np.linspace(0, 1, ARC_PIECES + 1)[None, :, None]
    straight = starts[:, None] * (1 - share) + ends[:, None] * share
    height = np.maximum(0.45 * np.linalg.norm(ends - starts, axis=1), least_height)
    straight[:, :, 2] += np.sin(np.pi * share[:, :, 0]) * height[:, None]
    return np.asarray(straight)


def along(starts: Array, ends: Array, radius: float) -> tuple[Array, Array, Array]:
    """Quaternions w x y z (N, 4), positions (N, 3) and scales (N, 3) that lay a cylinder from each start to its end."""
    direction = ends - starts
    length = np.linalg.norm(direction, axis=1)
    unit = np.divide(
        direction, length[:, None], out=np.tile([0.0, 0.0, 1.0], (len(starts), 1)), where=length[:, None] > 0
    )
    # The half-way rotation from z to the direction: 1 + z.u, z x u. For the opposite direction any half turn will do.
    quat = np.column_stack([1 + unit[:, 2], -unit[:, 1], unit[:, 0], np.zeros(len(unit))])
    quat[unit[:, 2] < -0.999999] = (0, 1, 0, 0)
    quat /= np.linalg.norm(quat, axis=1, keepdims=True)
    thick = np.full(len(starts), radius)
    return quat, starts, np.column_stack([thick, thick, length])


def dashes(path: Array, dash: float) -> Array:
    """Segments (M, 2, 3) of a dashed line along points (N, 3): ``dash`` metres drawn, as much left out."""
    if len(path) < 2:
        return np.zeros((0, 2, 3))
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    marks = np.arange(0.0, travelled[-1], 2 * dash)
    ends = np.minimum(marks + dash, travelled[-1])
    return np.stack([_at(path, travelled, marks), _at(path, travelled, ends)], axis=1)


def segments(path: Array) -> Array:
    """Segments (N - 1, 2, 3) of the line through points (N, 3)."""
    return np.stack([path[:-1], path[1:]], axis=1) if len(path) > 1 else np.zeros((0, 2, 3))


def _at(path: Array, travelled: Array, distances: Array) -> Array:
    return np.column_stack([np.interp(distances, travelled, path[:, k]) for k in range(3)])


def _outward(points: Array, faces: NDArray[np.integer]) -> NDArray[np.uint32]:
    """The faces with their corners in the order that shows their outside."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces = faces.copy()
    faces[inward] = faces[inward][:, [0, 2, 1]]
    return faces.astype(np.uint32)
