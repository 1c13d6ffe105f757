"""The path that another optimisation of the graph gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from server.scene.colours import Theme
from server.scene.lines import Lines, Segments, dashed
from server.scene.placed import PlacedGraph
from server.scene.shown import OptimisedPath

if TYPE_CHECKING:
    from viser import SceneApi

_PATH_PX = 2.4


class OptimisedLayer:
    """The path of each session, dashed."""

    def __init__(self, scene: SceneApi) -> None:
        self._path = Lines(scene, "/optimised/path", _PATH_PX)

    def draw(
        self, graph: PlacedGraph, optimised: OptimisedPath | None, dash_m: float, look: Theme, *, visible: bool
    ) -> None:
        """Show it; None shows nothing."""
        self._path.draw(optimised_path(graph, optimised, dash_m), look.coming, visible=visible)


def optimised_path(graph: PlacedGraph, optimised: OptimisedPath | None, dash_m: float) -> Segments:
    """Dashes (S, 2, 3) along the nodes of each session that took part."""
    found = [np.zeros((0, 2, 3))]
    if optimised is not None:
        rows = [row for row, node_id in enumerate(optimised.ids) if node_id in graph.rows]
        sessions = graph.map_ids[[graph.rows[optimised.ids[row]] for row in rows]]
        places = optimised.T_map[rows][:, :3, 3]
        found += [dashed(places[sessions == session], dash_m) for session in np.unique(sessions)]
    return np.concatenate(found)
