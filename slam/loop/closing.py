"""Putting verified candidates into the graph, as far as the graph can live with them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.errors import OptimizationError
from slam.graph.graph import Pair, PoseGraph
from slam.graph.verify import Closure, close_loops
from slam.loop.repair import taken_back, wrong_since
from slam.params import Params
from slam.types import Candidate, Link, Refusal

#: Puts links into a graph if that can live with them.
Trial = Callable[[PoseGraph, Sequence[Link], Params], Closure]


@dataclass(frozen=True, slots=True, eq=False)
class Closed:
    """Outcome of an update's loops.

    Attributes:
        candidates: every one with its verdict.
        links: those that are in the graph now.
        closure: the last optimisation.
        blamed: links that spoke against candidates.
        removed: old loop links that were taken back for them.
    """

    candidates: tuple[Candidate, ...] = ()
    links: tuple[Link, ...] = ()
    closure: Closure | None = None
    blamed: tuple[Link, ...] = ()
    removed: tuple[Link, ...] = ()

    @property
    def optimized(self) -> bool:
        """Whether poses of older nodes moved."""
        return bool(self.links)


class LoopCloser:
    """Closes loops, update after update, and remembers which old link the last refused ones contradicted."""

    def __init__(self, trial: Trial = close_loops) -> None:
        """``trial`` puts links into the graph if that can live with them."""
        self._trial = trial
        self._blamed: Link | None = None

    def close(
        self,
        graph: PoseGraph,
        candidates: Sequence[Candidate],
        params: Params,
        kept: Callable[[], Collection[Pair]] = tuple,
    ) -> Closed:
        """Like ``close``; an old loop link that speaks against candidates twice in a row goes, if that lets one in.

        Args:
            graph: gets the links and the poses.
            candidates: of this update.
            params: the RGBD and Optimizer groups are read.
            kept: pairs that somebody has approved, which never go; asked for only when a link is about to.
        """
        closed = close(graph, candidates, params, self._trial)
        if closed.closure is None:
            return closed
        last, self._blamed = self._blamed, next((k for k in closed.blamed if graph.links.get(k.pair) is k), None)
        if self._blamed is None or self._blamed is not last or params.RGBD.OptimizeMaxErrorRepairRadius <= 0:
            return closed
        return _repaired(graph, candidates, self._blamed, kept(), params, self._trial) or closed


def _repaired(
    graph: PoseGraph, candidates: Sequence[Candidate], old: Link, kept: Collection[Pair], params: Params, trial: Trial
) -> Closed | None:
    """The outcome without the old link and its neighbours; None where no candidate comes in by that: then they stay."""
    removed, poses = wrong_since(old, graph, kept, params), graph.poses
    for link in removed:
        graph.remove_link(link.pair)
    closed = close(graph, candidates, params, trial) if removed else Closed()
    if not closed.links:
        for link in removed:
            graph.add_link(link)
        graph.poses = poses
        return None
    gone = tuple(taken_back(link, old, params) for link in removed)
    return replace(closed, candidates=(*closed.candidates, *gone), removed=tuple(removed))


def limited(candidate: Candidate, most: NDArray[np.float64]) -> Candidate:
    """The candidate with no larger information on any axis than ``most`` (6,) (``RGBD/LoopCovLimited``)."""
    if candidate.information is None:
        return candidate
    scale = np.sqrt(np.minimum(1.0, most / np.diagonal(candidate.information)))
    return replace(candidate, information=candidate.information * np.outer(scale, scale))


def close(graph: PoseGraph, candidates: Sequence[Candidate], params: Params, trial: Trial = close_loops) -> Closed:
    """Adds the candidates that the images agreed with; all together, or else one by one.

    RTAB-Map lets all loops of an update go when the graph refuses one of them; tried alone, the others stay.
    """
    agreed = [candidate for candidate in candidates if candidate.refusal is None]
    if not agreed:
        return Closed(tuple(candidates))
    together = _try(graph, agreed, params, trial)
    if together.accepted or len(agreed) == 1:
        verdicts = {id(candidate): together for candidate in agreed}
    else:
        verdicts = {id(candidate): _try(graph, [candidate], params, trial) for candidate in agreed}
    judged = tuple(replace(c, refusal=verdicts[id(c)].refusal) if id(c) in verdicts else c for c in candidates)
    links = tuple(c.link for c in judged if c.refusal is None and c.link is not None)
    closures = [verdict.closure for verdict in verdicts.values()]
    blamed = tuple(closure.blamed for closure in closures if closure is not None and closure.blamed is not None)
    return Closed(judged, links, closures[-1], blamed)


@dataclass(frozen=True, slots=True, eq=False)
class _Verdict:
    """What the graph says of some candidates; the closure is None when it could not even be solved."""

    closure: Closure | None
    refusal: Refusal | None

    @property
    def accepted(self) -> bool:
        return self.refusal is None


def _try(graph: PoseGraph, candidates: Sequence[Candidate], params: Params, trial: Trial) -> _Verdict:
    try:
        closure = trial(graph, [c.link for c in candidates if c.link is not None], params)
    except OptimizationError as error:
        return _Verdict(None, Refusal("optimization", float("nan"), float("nan"), str(error)))
    return _Verdict(closure, closure.refusal)
