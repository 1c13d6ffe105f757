"""The links of the graph."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair
from server.scene.batched import Batch
from server.scene.colours import Theme
from server.scene.lines import Lines
from server.scene.placed import LOOPS, LinkKind, PlacedGraph
from server.scene.shapes import ball
from server.scene.tone import Rgb

if TYPE_CHECKING:
    from viser import SceneApi

Array = NDArray[np.float64]

_THICKNESS_PX = {
    LinkKind.NEIGHBOR: 1.5,
    LinkKind.VIRTUAL: 1.0,
    LinkKind.PROXIMITY: 1.8,
    LinkKind.TIME: 1.8,
    LinkKind.LOOP: 2.4,
    LinkKind.USER: 2.4,
    LinkKind.REFUSED: 1.4,
}
#: Pieces of an arc, an even number: of one among few, among more than ``_MANY``, and where every other is a gap.
_STEPS, _FEWER_STEPS, _DASHED_STEPS = 12, 4, 36
_MANY = 1500


class LinkLayer:
    """Straight lines along the path and arcs for loops, dashed where refused; ``on_click`` gets a clicked loop's ids.

    Lines can't be clicked in viser, and a loop often joins nodes that lie almost on each other: so each loop rises as
    an arc with a knot at its top.
    """

    def __init__(self, scene: SceneApi, on_click: Callable[[Pair], None]) -> None:
        self._on_click = on_click
        self._graph: PlacedGraph | None = None
        self._lines = {kind: Lines(scene, f"/graph/{kind.value}", _THICKNESS_PX[kind]) for kind in LinkKind}
        self._knots = {kind: Batch(scene, f"/graph/knots/{kind.value}", self._picker(kind)) for kind in LOOPS}

    def draw(
        self, graph: PlacedGraph, radius: float, look: Theme, *, visible: bool, hidden: Collection[str] = ()
    ) -> None:
        """Show the links as they are now but for ``hidden`` kinds; ``radius`` is that of the nodes."""
        self._graph = graph
        for kind, rows in graph.links.items():
            if kind.value in hidden:
                rows = rows[:0]
            ends, rgb = graph.positions[rows], colour(kind, look)
            if kind not in LOOPS:
                self._lines[kind].draw(ends, rgb, visible=visible)
                continue
            arcs = arc(ends, radius, _steps(kind, len(rows)))
            pieces = segments(arcs)
            self._lines[kind].draw(pieces[::2] if kind is LinkKind.REFUSED else pieces, rgb, visible=visible)
            tops = arcs[:, arcs.shape[1] // 2]
            paint = np.tile(np.array(rgb, dtype=np.uint8), (len(rows), 1))
            self._knots[kind].draw(tops, paint, ball(4 * len(rows)), 0.55 * radius, visible=visible)

    def _picker(self, kind: LinkKind) -> Callable[[int], None]:
        def clicked(index: int) -> None:
            graph = self._graph
            if graph is not None and index < len(graph.links[kind]):
                self._on_click(graph.pair_of(kind, index))

        return clicked


def colour(kind: LinkKind, look: Theme) -> Rgb:
    """The colour of links of a kind."""
    by_kind = {
        LinkKind.NEIGHBOR: look.neighbor,
        LinkKind.LOOP: look.loop,
        LinkKind.PROXIMITY: look.proximity,
        LinkKind.TIME: look.in_time,
        LinkKind.USER: look.user,
        LinkKind.VIRTUAL: look.virtual,
        LinkKind.REFUSED: look.refused,
    }
    return by_kind[kind]


def _steps(kind: LinkKind, links: int) -> int:
    if kind is LinkKind.REFUSED:
        return _DASHED_STEPS
    return _STEPS if links <= _MANY else _FEWER_STEPS


def arc(ends: Array, radius: float, steps: int) -> Array:
    """Points (L, steps + 1, 3) of a parabola over each pair of ends (L, 2, 3), some node radii high."""
    share = np.linspace(0.0, 1.0, steps + 1)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    height = 3.2 * radius + 0.2 * np.minimum(length, 60.0 * radius)
    points = ends[:, :1] + share[None, :, None] * (ends[:, 1:] - ends[:, :1])
    points[:, :, 2] += height[:, None] * (4.0 * share * (1.0 - share))[None]
    return np.asarray(points)


def segments(paths: Array) -> Array:
    """Segments (L * (P - 1), 2, 3) of paths (L, P, 3)."""
    return np.stack([paths[:, :-1], paths[:, 1:]], axis=2).reshape(-1, 2, 3)
