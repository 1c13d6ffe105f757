"""The place that an update took for the most probable one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from server.browse.timeline import Moment
from server.scene.colours import Theme
from server.scene.lines import Lines, chain
from server.scene.links import arc
from server.scene.placed import PlacedGraph

if TYPE_CHECKING:
    from viser import SceneApi

_ARC_PX = 3.0
_STEPS = 24


class HypothesisLayer:
    """An arc from the newest node of a moment to its best hypothesis, in the colour of the robot."""

    def __init__(self, scene: SceneApi) -> None:
        self._arc = Lines(scene, "/hypothesis", _ARC_PX)

    def draw(self, graph: PlacedGraph, moment: Moment | None, radius: float, look: Theme, *, visible: bool) -> None:
        """Show it for a moment that has one; ``radius`` is that of the nodes."""
        row = graph.rows.get(moment.best_id) if moment is not None and visible else None
        path = np.zeros((1, 3)) if row is None else arc(graph.positions[[[-1, row]]], radius, _STEPS)[0]
        self._arc.draw(chain(path), look.newest)
