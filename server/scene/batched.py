"""Many small equal shapes that can be clicked, in a few scene nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.shapes import Shape
from server.scene.tone import for_batch

if TYPE_CHECKING:
    from viser import BatchedMeshHandle, SceneApi, SceneNodePointerEvent

Positions = NDArray[np.float64]
Colours = NDArray[np.uint8]

#: Instances of one scene node: a map that grows, or whose past somebody goes through, sends only the last piece again.
PIECE = 512
_UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]], dtype=np.float32)
#: Relative change of the size that is worth sending the shape again.
_SIZE_STEP = 0.2


class Batch:
    """Instances of one shape, each with a position and a colour; ``on_click`` gets the index of the one clicked.

    Whoever draws only hands over all of it; what did not change or is not to be seen is not sent.
    """

    def __init__(self, scene: SceneApi, name: str, on_click: Callable[[int], None]) -> None:
        self._scene = scene
        self._name = name
        self._on_click = on_click
        self._shape: Shape | None = None
        self._size = 0.0
        self._pieces: list[BatchedMeshHandle] = []

    def draw(self, positions: Positions, colours: Colours, shape: Shape, size: float, *, visible: bool = True) -> None:
        """Show instances at positions (N, 3), map frame, in colours (N, 3); ``size`` scales the shape."""
        for piece in self._pieces:
            piece.visible = visible
        if not visible:
            return
        if shape is not self._shape or abs(size - self._size) > _SIZE_STEP * self._size:
            self._reshape(shape, size)
        sent = for_batch(colours) if len(colours) else colours
        wanted = -(-len(positions) // PIECE)
        for number in range(wanted):
            part = slice(number * PIECE, (number + 1) * PIECE)
            self._draw_piece(number, shape, positions[part], sent[part])
        for gone in self._pieces[wanted:]:
            gone.remove()
        del self._pieces[wanted:]

    def _reshape(self, shape: Shape, size: float) -> None:
        self._shape, self._size = shape, size
        for piece in self._pieces:
            piece.vertices = (shape.vertices * size).astype(np.float32)
            piece.faces = shape.faces.astype(np.uint32)

    def _draw_piece(self, number: int, shape: Shape, positions: Positions, colours: Colours) -> None:
        if number == len(self._pieces):
            self._pieces.append(self._make(number, shape, positions, colours))
            return
        piece = self._pieces[number]
        if len(piece.batched_positions) != len(positions):
            piece.batched_wxyzs = _UPRIGHT.repeat(len(positions), axis=0)
        piece.batched_positions = positions.astype(np.float32)
        piece.batched_colors = colours

    def _make(self, number: int, shape: Shape, positions: Positions, colours: Colours) -> BatchedMeshHandle:
        made = self._scene.add_batched_meshes_simple(
            f"{self._name}/{number}",
            shape.vertices * self._size,
            shape.faces,
            _UPRIGHT.repeat(len(positions), axis=0),
            positions,
            batched_colors=colours,
            cast_shadow=False,
            receive_shadow=False,
        )

        def clicked(event: SceneNodePointerEvent[BatchedMeshHandle]) -> None:
            if event.instance_index is not None:
                self._on_click(number * PIECE + event.instance_index)

        made.on_click(clicked)
        return made
