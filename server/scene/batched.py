"""Many small equal shapes that can be clicked, in a few scene nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.tone import for_batch

if TYPE_CHECKING:
    from viser import BatchedMeshHandle, SceneApi, SceneNodePointerEvent

#: Instances of one scene node: a map that grows sends only the last piece again.
PIECE = 1024
#: Relative change of the size that is worth sending the shape again.
_SIZE_STEP = 0.2


class Batch:
    """Instances of one shape, each with a position and a colour.

    Whoever draws only hands over all of it; what did not change is not sent.
    """

    def __init__(
        self,
        scene: SceneApi,
        name: str,
        shape: tuple[NDArray[np.float64], NDArray[np.int64]],
        on_click: Callable[[int], None],
    ) -> None:
        self._scene = scene
        self._name = name
        self._vertices, self._faces = shape
        self._on_click = on_click
        self._size = 0.0
        self._pieces: list[BatchedMeshHandle] = []

    def draw(
        self, positions: NDArray[np.float64], colours: NDArray[np.uint8], size: float, *, visible: bool = True
    ) -> None:
        """Show instances at positions (N, 3), map frame, in colours (N, 3); ``size`` scales the shape."""
        sent = for_batch(colours)
        resized = abs(size - self._size) > _SIZE_STEP * self._size
        if resized:
            self._size = size
        for number, start in enumerate(range(0, len(positions), PIECE)):
            part = slice(start, start + PIECE)
            self._draw_piece(number, positions[part], sent[part], resized=resized)
        for gone in self._pieces[-(-len(positions) // PIECE) :]:
            gone.remove()
        del self._pieces[-(-len(positions) // PIECE) :]
        for piece in self._pieces:
            piece.visible = visible

    def _draw_piece(
        self, number: int, positions: NDArray[np.float64], colours: NDArray[np.uint8], *, resized: bool
    ) -> None:
        piece = self._pieces[number] if number < len(self._pieces) else None
        if piece is None or len(piece.batched_positions) != len(positions):
            made = self._make(number, positions, colours)
            self._pieces[number : number + 1] = [made]
            return
        piece.batched_positions = positions.astype(np.float32)
        piece.batched_colors = colours
        if resized:
            piece.vertices = (self._vertices * self._size).astype(np.float32)

    def _make(self, number: int, positions: NDArray[np.float64], colours: NDArray[np.uint8]) -> BatchedMeshHandle:
        piece = self._scene.add_batched_meshes_simple(
            f"{self._name}/{number}",
            self._vertices * self._size,
            self._faces,
            np.tile(np.array([1.0, 0.0, 0.0, 0.0]), (len(positions), 1)),
            positions,
            batched_colors=colours,
            cast_shadow=False,
            receive_shadow=False,
        )

        def clicked(event: SceneNodePointerEvent[BatchedMeshHandle]) -> None:
            if event.instance_index is not None:
                self._on_click(number * PIECE + event.instance_index)

        piece.on_click(clicked)
        return piece


def icosphere(subdivisions: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (V, 3) of radius 1 and faces (F, 3): an icosahedron whose faces were cut into four so many times."""
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
    return np.array(vertices), np.array(faces, dtype=np.int64)


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
