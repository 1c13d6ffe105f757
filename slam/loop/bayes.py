"""Bayes filter over the places of working memory and the virtual place of being nowhere known.

Angeli et al. 2008 and Labbe and Michaud 2013, section III-C: posterior = likelihood x (transition x prior).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from slam.graph.graph import PoseGraph
from slam.loop.transition import STEP, Transition
from slam.params import Params
from slam.types import Posterior

Array = NDArray[np.float64]


class BayesFilter:
    """Keeps the belief between updates."""

    def __init__(self) -> None:
        self._belief: dict[int, float] = {}
        self._virtual = 1.0
        self._transition = Transition()

    def update(
        self, ids: Sequence[int], likelihood: Array, virtual_likelihood: float, graph: PoseGraph, params: Params
    ) -> Posterior:
        """New belief over ``ids`` (ascending) and the virtual place.

        A place that was not there before starts at 0, at the very first update all start equal.
        """
        prior = self._prior(ids)
        transition = self._transition.update(ids, graph, params)
        weighted = np.concatenate([[virtual_likelihood], likelihood]) * (transition @ prior)
        total = float(weighted.sum())
        belief = weighted / total if total > 0 else np.full(len(weighted), 1.0 / len(weighted))
        self._virtual = float(belief[0])
        self._belief = dict(zip(ids, belief[1:].tolist(), strict=True))
        return Posterior(
            np.array(ids, np.int32), np.asarray(likelihood), belief[1:], float(belief[0]), float(virtual_likelihood)
        )

    def _prior(self, ids: Sequence[int]) -> Array:
        if not self._belief:
            prior = np.ones(len(ids) + 1)
        else:
            prior = np.array([self._virtual, *(self._belief.get(i, 0.0) for i in ids)])
        return np.asarray(prior / prior.sum()) if prior.sum() > 0 else np.full(len(prior), 1.0 / len(prior))


def neighbours_in_time(node_id: int, graph: PoseGraph, reach: int) -> set[int]:
    """Nodes at most ``reach`` neighbour links from a node, itself included."""
    return set(graph.within(node_id, reach, lambda link: 1 if link.type in STEP else None))
