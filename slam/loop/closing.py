"""Putting verified candidates into the graph, as far as the graph can live with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slam.errors import OptimizationError
from slam.graph.graph import PoseGraph
from slam.graph.verify import Closure, close_loops
from slam.params import Params
from slam.types import Candidate, Link, Refusal


@dataclass(frozen=True, slots=True, eq=False)
class Closed:
    """Outcome: every candidate with its verdict, the links that are in the graph now, and the last optimisation."""

    candidates: tuple[Candidate, ...] = ()
    links: tuple[Link, ...] = ()
    closure: Closure | None = None

    @property
    def optimized(self) -> bool:
        """Whether poses of older nodes moved."""
        return bool(self.links)


def limited(candidate: Candidate, most: NDArray[np.float64]) -> Candidate:
    """The candidate with no larger information on any axis than ``most`` (6,) (``RGBD/LoopCovLimited``)."""
    if candidate.information is None:
        return candidate
    scale = np.sqrt(np.minimum(1.0, most / np.diagonal(candidate.information)))
    return replace(candidate, information=candidate.information * np.outer(scale, scale))


def close(graph: PoseGraph, candidates: Sequence[Candidate], params: Params) -> Closed:
    """Adds the candidates that the images agreed with; all together, or else one by one.

    RTAB-Map lets all loops of an update go when the graph refuses one of them; tried alone, the others stay.
    """
    agreed = [candidate for candidate in candidates if candidate.refusal is None]
    if not agreed:
        return Closed(tuple(candidates))
    together = _try(graph, agreed, params)
    if together.accepted or len(agreed) == 1:
        verdicts = {id(candidate): together for candidate in agreed}
    else:
        verdicts = {id(candidate): _try(graph, [candidate], params) for candidate in agreed}
    judged = tuple(replace(c, refusal=verdicts[id(c)].refusal) if id(c) in verdicts else c for c in candidates)
    links = tuple(_link(c) for c in judged if c.refusal is None)
    return Closed(judged, links, list(verdicts.values())[-1].closure)


@dataclass(frozen=True, slots=True, eq=False)
class _Verdict:
    """What the graph says of some candidates; the closure is None when it could not even be solved."""

    closure: Closure | None
    refusal: Refusal | None

    @property
    def accepted(self) -> bool:
        return self.refusal is None


def _try(graph: PoseGraph, candidates: Sequence[Candidate], params: Params) -> _Verdict:
    try:
        closure = close_loops(graph, [_link(candidate) for candidate in candidates], params)
    except OptimizationError as error:
        return _Verdict(None, Refusal("optimization", float("nan"), float("nan"), str(error)))
    return _Verdict(closure, closure.refusal)


def _link(candidate: Candidate) -> Link:
    assert candidate.information is not None
    return Link(candidate.from_id, candidate.to_id, candidate.type, candidate.T_from_to, candidate.information)
