"""What another threshold would make of the map: loops that would come and go, and the path as it would be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from server.browse.snapshot import Pair
from server.scene.colours import Theme
from server.scene.lines import Lines, Segments, dashed
from server.scene.links import arc, segments
from server.scene.measure import Measure
from server.scene.placed import PlacedGraph
from server.scene.tone import Rgb
from server.schemas import LoopWhatIf
from slam.loop.foresight import Outcome

if TYPE_CHECKING:
    from viser import SceneApi

_COMING_PX, _GOING_PX, _PATH_PX = 3.0, 1.4, 2.0
#: Pieces of an arc, of which every other is a gap.
_STEPS = 36
#: Of the colour of loops, the share that is left of one that would go.
_FADED = 0.35


class GhostLayer:
    """Loops that would come as dashed arcs, those that would go faded, and the path with them dashed."""

    def __init__(self, scene: SceneApi) -> None:
        self._coming = Lines(scene, "/ghosts/coming", _COMING_PX)
        self._going = Lines(scene, "/ghosts/going", _GOING_PX)
        self._path = Lines(scene, "/ghosts/path", _PATH_PX)

    def draw(
        self, graph: PlacedGraph, what_if: LoopWhatIf | None, measure: Measure, look: Theme, *, visible: bool
    ) -> None:
        """Show what would be; None shows nothing."""
        coming = segments(_arcs(graph, pairs_of(what_if, Outcome.COMES), measure))[::2]
        going = segments(_arcs(graph, pairs_of(what_if, Outcome.GOES), measure))
        self._coming.draw(coming, look.coming, visible=visible)
        self._going.draw(going, _faded(look), visible=visible)
        self._path.draw(ghost_path(graph, what_if, measure.dash), look.coming, visible=visible)


def pairs_of(what_if: LoopWhatIf | None, outcome: Outcome) -> list[Pair]:
    """Both ids, smaller first, of the loops that have this outcome."""
    loops = [] if what_if is None else what_if.loops
    return [(min(loop.from_, loop.to), max(loop.from_, loop.to)) for loop in loops if loop.outcome is outcome]


def ghost_path(graph: PlacedGraph, what_if: LoopWhatIf | None, dash_m: float) -> Segments:
    """The path (S, 2, 3) of each session as it would be; nothing where that is not known or nothing would move."""
    found = [np.zeros((0, 2, 3))]
    if what_if is None or what_if.graph is None or not what_if.graph.moved:
        return found[0]
    places = {i: pose[:3] for i, pose in zip(what_if.graph.ids, what_if.graph.poses, strict=True)}
    for session in np.unique(graph.map_ids):
        ids = [i for i in graph.ids[graph.map_ids == session].tolist() if i in places]
        found.append(dashed(np.array([places[i] for i in ids], np.float64).reshape(-1, 3), dash_m))
    return np.concatenate(found)


def _arcs(graph: PlacedGraph, pairs: list[Pair], measure: Measure) -> NDArray[np.float64]:
    rows = [(graph.rows[a], graph.rows[b]) for a, b in pairs if a in graph.rows and b in graph.rows]
    ends = graph.positions[np.array(rows, np.int64).reshape(-1, 2)]
    return arc(ends, measure.node, _STEPS)


def _faded(look: Theme) -> Rgb:
    """The colour of loops, most of it gone into the ground behind them."""
    mixed = _FADED * np.array(look.loop) + (1.0 - _FADED) * np.array(look.background).mean(axis=0)
    r, g, b = (int(value) for value in np.rint(mixed))
    return r, g, b
