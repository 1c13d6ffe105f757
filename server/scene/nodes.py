"""The nodes of the graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from server.scene.batched import Batch
from server.scene.colours import Theme, node_colours
from server.scene.placed import Ints, PlacedGraph
from server.scene.shapes import ball
from server.schemas.scene import Colouring

if TYPE_CHECKING:
    from viser import SceneApi


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
        colours = node_colours(graph, how, look, values)
        self._balls.draw(graph.positions, colours, ball(len(graph)), radius, visible=visible)

    def _clicked(self, index: int) -> None:
        ids = self._ids
        if index < len(ids):
            self._on_click(int(ids[index]))
