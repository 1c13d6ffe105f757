"""Which nodes show their cloud."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from server.scene.placed import PlacedGraph

Array = NDArray[np.float64]

#: More clouds than this are slow in a browser: each is a scene node of its own.
MOST = 150
_FIRST_DISTANCE_M = 0.25
_FIRST_ANGLE = np.radians(20.0)
_WIDER = 1.25


class Choice:
    """Nodes that see something the chosen ones don't: farther away than a distance, or turned by more than an angle.

    Both start small and grow whenever more than ``MOST`` are chosen. A node once chosen stays until then, however the
    poses move, so that its points are sent only once.
    """

    def __init__(self) -> None:
        self.ids: list[int] = []
        self._looked_at: set[int] = set()
        self._distance = _FIRST_DISTANCE_M
        self._angle = _FIRST_ANGLE

    def update(self, graph: PlacedGraph, usable: Iterable[int]) -> None:
        """Look at the nodes that are new; ``usable`` are those that have images."""
        self.ids = [node_id for node_id in self.ids if node_id in graph.rows]
        new = sorted(node_id for node_id in set(usable) - self._looked_at if node_id in graph.rows)
        self._looked_at.update(new)
        self._add(graph, new)
        while len(self.ids) > MOST:
            self._distance *= _WIDER
            self._angle = min(self._angle * _WIDER, np.radians(60.0))
            before, self.ids = self.ids, []
            self._add(graph, before)

    def _add(self, graph: PlacedGraph, candidates: list[int]) -> None:
        """Choose from candidates those that no chosen one is near to."""
        rows = [graph.rows[node_id] for node_id in self.ids + candidates]
        positions, forward = graph.positions[rows], graph.T_map[rows, :3, 0]
        chosen = np.zeros(len(rows), dtype=bool)
        chosen[: len(self.ids)] = True
        for i in range(len(self.ids), len(rows)):
            near = np.linalg.norm(positions[chosen] - positions[i], axis=1) < self._distance
            alike = forward[chosen] @ forward[i] > np.cos(self._angle)
            chosen[i] = not (near & alike).any()
            if chosen[i]:
                self.ids.append(candidates[i - (len(rows) - len(candidates))])
