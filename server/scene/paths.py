"""The paths beside the map's own: odometry and ground truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.scene.colours import Theme
from server.scene.lines import Lines, Segments, chain, dashed
from server.scene.placed import PlacedGraph
from slam.evaluate import align
from slam.geometry import inverse, transform

if TYPE_CHECKING:
    from viser import SceneApi


_NONE: Segments = np.zeros((0, 2, 3))


class PathLayer:
    """Odometry dashed, ground truth solid."""

    def __init__(self, scene: SceneApi) -> None:
        self._odometry = Lines(scene, "/paths/odometry", 1.6)
        self._truth = Lines(scene, "/paths/truth", 1.6)

    def draw(
        self, graph: PlacedGraph, dash_m: float, look: Theme, *, odometry: bool, truth: bool, until: int | None = None
    ) -> None:
        """Show either or both as they are now, up to a node."""
        self._odometry.draw(odometry_path(graph, dash_m, until) if odometry else _NONE, look.odometry, visible=odometry)
        self._truth.draw(true_path(graph, until) if truth else _NONE, look.truth, visible=truth)


def odometry_path(graph: PlacedGraph, dash_m: float, until: int | None = None) -> Segments:
    """Where odometry alone would have gone (S, 2, 3), each session beginning where the map has its first node."""
    found = [_NONE]
    for rows in _sessions(graph, _known(graph.T_odom) & _before(graph, until)):
        T_map_odom = graph.T_map[rows[0]] @ inverse(graph.T_odom[rows[0]])
        found.append(dashed(transform(T_map_odom, graph.T_odom[rows, :3, 3]), dash_m))
    return np.concatenate(found)


def true_path(graph: PlacedGraph, until: int | None = None) -> Segments:
    """The true path (S, 2, 3) up to a node, laid over the map's as well as all of it goes."""
    known = _known(graph.T_world)
    if known.sum() < 2:
        return _NONE
    T_map_world = align(graph.positions[known], graph.T_world[known, :3, 3])
    found = [_NONE]
    found += [
        chain(transform(T_map_world, graph.T_world[rows, :3, 3]))
        for rows in _sessions(graph, known & _before(graph, until))
    ]
    return np.concatenate(found)


def _known(T: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(T).all(axis=(1, 2)))


def _before(graph: PlacedGraph, until: int | None) -> NDArray[np.bool_]:
    return np.asarray(graph.ids <= (np.inf if until is None else until))


def _sessions(graph: PlacedGraph, known: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Rows of the known nodes of each session that has any."""
    rows = [np.flatnonzero(known & (graph.map_ids == session)) for session in np.unique(graph.map_ids)]
    return [chosen for chosen in rows if len(chosen)]
