"""The links: lines along the path, arcs for loops, dashed arcs for loops that were refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from server.browse.snapshot import Pair
from server.scene import palette
from server.scene.model import Array, SceneModel
from server.scene.shapes import ARC_PIECES, along, arcs, cylinder
from slam.types import Link, LinkType

OnPick = Callable[[int, int], None]
_LOOP_RADIUS = 0.07
_LINE_PIXELS = 1.6


class LinkLayer:
    """Draws all links with three handles."""

    def __init__(self, server: viser.ViserServer, on_pick: OnPick) -> None:
        self._server = server
        self._on_pick = on_pick
        self._lines: viser.LineSegmentsHandle | None = None
        self._refused: viser.LineSegmentsHandle | None = None
        self._loops: viser.BatchedMeshHandle | None = None
        self._pairs: tuple[Pair, ...] = ()

    def draw(self, model: SceneModel, *, visible: bool) -> None:
        """Show the links of a model."""
        loops = [link for link in model.links if link.type.is_loop]
        plain = [link for link in model.links if not link.type.is_loop]
        self._draw_lines(model, plain, visible)
        self._draw_loops(model, loops, visible)
        self._draw_refused(model, visible)

    def _draw_lines(self, model: SceneModel, links: Sequence[Link], visible: bool) -> None:
        starts, ends = _ends(model, [link.pair for link in links])
        colors = np.array([link_color(link.type) for link in links], dtype=np.uint8).reshape(-1, 1, 3)
        self._lines = _lines(
            self._server, "/graph/links", self._lines, np.stack([starts, ends], axis=1), np.repeat(colors, 2, axis=1)
        )
        if self._lines is not None:
            self._lines.visible = visible

    def _draw_refused(self, model: SceneModel, visible: bool) -> None:
        points = arcs(*_ends(model, model.refused), 2.0 * model.step)[:, : ARC_PIECES + 1]
        dashes = np.stack([points[:, 0:-1:2], points[:, 1::2]], axis=2).reshape(-1, 2, 3)
        self._refused = _lines(self._server, "/graph/refused", self._refused, dashes, np.array(palette.REFUSED))
        if self._refused is not None:
            self._refused.visible = visible

    def _draw_loops(self, model: SceneModel, loops: Sequence[Link], visible: bool) -> None:
        self._pairs = tuple((link.from_id, link.to_id) for link in loops)
        quats, positions, scales = loop_cylinders(model, self._pairs, _LOOP_RADIUS * model.step)
        if self._loops is None and len(positions):
            self._loops = self._add_loops(quats, positions, scales)
        elif self._loops is not None:
            self._loops.batched_wxyzs = quats
            self._loops.batched_positions = positions
            self._loops.batched_scales = scales
        if self._loops is not None:
            self._loops.visible = visible and len(positions) > 0

    def _add_loops(self, quats: np.ndarray, positions: np.ndarray, scales: np.ndarray) -> viser.BatchedMeshHandle:
        handle = self._server.scene.add_batched_meshes_simple(
            "/graph/loops",
            *cylinder(),
            batched_wxyzs=quats,
            batched_positions=positions,
            batched_scales=scales,
            batched_colors=palette.LOOP,
            cast_shadow=False,
            receive_shadow=False,
            lod="off",
        )
        handle.on_click(self._clicked)
        return handle

    def _clicked(self, event: viser.SceneNodePointerEvent[viser.BatchedMeshHandle]) -> None:
        if event.instance_index is not None and event.instance_index // ARC_PIECES < len(self._pairs):
            self._on_pick(*self._pairs[event.instance_index // ARC_PIECES])


def link_color(kind: LinkType) -> palette.Rgb:
    """Colour of a link that is no loop."""
    return palette.LINKS.get(kind, palette.OTHER_LINK)


def loop_cylinders(
    model: SceneModel, pairs: Sequence[Pair], radius: float
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Quaternions w x y z, positions and scales of the cylinders of all arcs, ``ARC_PIECES`` for each pair."""
    points = arcs(*_ends(model, pairs), 2.0 * model.step)
    quats, positions, scales = along(points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3), radius)
    return quats.astype(np.float32), positions.astype(np.float32), scales.astype(np.float32)


def _ends(model: SceneModel, pairs: Sequence[Pair]) -> tuple[Array, Array]:
    rows = np.array([[model.rows[a], model.rows[b]] for a, b in pairs], dtype=np.int64).reshape(-1, 2)
    return model.positions[rows[:, 0]], model.positions[rows[:, 1]]


def _lines(
    server: viser.ViserServer,
    name: str,
    handle: viser.LineSegmentsHandle | None,
    points: Array,
    colors: NDArray[np.integer],
) -> viser.LineSegmentsHandle | None:
    """The handle with these segments; None as long as there are none."""
    if not len(points):
        if handle is not None:
            handle.remove()
        return None
    drawn = points.astype(np.float32)
    if handle is None:
        return server.scene.add_line_segments(
            name, drawn, colors.astype(np.uint8), thickness=_LINE_PIXELS, thickness_units="screen"
        )
    handle.points = drawn
    if colors.ndim > 1:
        handle.colors = colors.astype(np.uint8)
    return handle
