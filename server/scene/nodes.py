"""The nodes of the graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from server.scene.batched import Batch
from server.scene.colours import Theme, node_colours
from server.scene.placed import Ints, PlacedGraph
from server.scene.shapes import icosphere
from server.schemas.scene import Colouring

if TYPE_CHECKING:
    from viser import SceneApi

#: Nodes that are drawn as round as they can be; more of them, seen from farther away, are drawn with a quarter of it.
_FINE = 2000


class NodeLayer:
    """A small ball for each node; ``on_click`` gets the id of the one that was clicked."""

    def __init__(self, scene: SceneApi, on_click: Callable[[int], None]) -> None:
        self._on_click = on_click
        self._ids: Ints = np.zeros(0, dtype=np.int64)
        self._balls = Batch(scene, "/graph/nodes", self._clicked)

    def draw(
        self,
        graph: PlacedGraph,
        radius: float,
        how: Colouring,
        look: Theme,
        *,
        visible: bool,
        values: Mapping[int, float] | None = None,
    ) -> None:
        """Show the nodes as they are now."""
        self._ids = graph.ids
        ball = icosphere(2 if len(graph) <= _FINE else 1)
        self._balls.draw(graph.positions, node_colours(graph, how, look, values), ball, radius, visible=visible)

    def _clicked(self, index: int) -> None:
        ids = self._ids
        if index < len(ids):
            self._on_click(int(ids[index]))
