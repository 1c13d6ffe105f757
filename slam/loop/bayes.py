"""Bayes filter over the places of working memory and the virtual place of being nowhere known.

Angeli et al. 2008 and Labbe and Michaud 2013, section III-C: posterior = likelihood x (transition x prior).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.types import LinkType, Posterior

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
#: Links that tie two nodes to one place; proximity links aren't followed.
_SAME_PLACE = (LinkType.GLOBAL_CLOSURE, LinkType.USER_CLOSURE)
_STEP = (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED)


class BayesFilter:
    """Keeps the belief between updates."""

    def __init__(self) -> None:
        self._belief: dict[int, float] = {}
        self._virtual = 1.0

    def update(
        self, ids: Sequence[int], likelihood: Array, virtual_likelihood: float, graph: PoseGraph, params: Params
    ) -> Posterior:
        """New belief over ``ids`` (ascending) and the virtual place.

        A place that was not there before starts at 0, at the very first update all start equal.
        """
        prior = self._prior(ids)
        transition = transition_matrix(ids, graph, params)
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


def transition_matrix(ids: Sequence[int], graph: PoseGraph, params: Params) -> Array:
    """(N + 1, N + 1) probabilities of going from a column's place to a row's; row and column 0 are the virtual place.

    Each column sums to one.
    """
    values = np.array([float(v) for v in params.Bayes.PredictionLC.split()])
    count = len(ids)
    starts, targets, costs = _adjacency(ids, graph)
    matrix = np.zeros((count + 1, count + 1))
    _fill(matrix, starts, targets, costs, values)
    stay = params.Bayes.VirtualPlacePriorThr
    matrix[0, 0] = stay if count else 1.0
    matrix[1:, 0] = (1.0 - stay) / count if count else 0.0
    return matrix


def neighbours_in_time(node_id: int, graph: PoseGraph, reach: int) -> set[int]:
    """Nodes at most ``reach`` neighbour links from a node, itself included."""
    return set(graph.within(node_id, reach, lambda link: 1 if link.type in _STEP else None))


def _adjacency(ids: Sequence[int], graph: PoseGraph) -> tuple[Ints, Ints, Ints]:
    """Links among ``ids`` as starts (N + 1,), targets and costs: 0 within a place, 1 to a neighbour."""
    row_of: Mapping[int, int] = {node_id: row for row, node_id in enumerate(ids)}
    starts, targets, costs = [0], [], []
    for node_id in ids:
        for other, link in graph.places_beside(node_id):
            row = row_of.get(other)
            if row is not None and (link.type in _SAME_PLACE or link.type in _STEP):
                targets.append(row)
                costs.append(0 if link.type in _SAME_PLACE else 1)
        starts.append(len(targets))
    return np.array(starts, np.int32), np.array(targets, np.int32), np.array(costs, np.int32)


@njit(cache=True)
def _fill(matrix: Array, starts: Ints, targets: Ints, costs: Ints, values: Array) -> None:
    """Columns of real places: ``values`` by graph distance, what is missing goes to staying, then normalised."""
    count = len(starts) - 1
    depth = len(values) - 2
    smallest = values.min()
    total = values.sum()
    distance = np.full(count, -1, np.int32)
    queue = np.empty(2 * (count + len(targets)) + 2, np.int32)
    for column in range(count):
        distance[:] = -1
        middle = count + len(targets)
        head, tail = middle, middle + 1
        queue[head] = column
        distance[column] = 0
        added = 0.0
        done = np.zeros(count, np.bool_)
        while head < tail:
            at = queue[head]
            head += 1
            if done[at]:
                continue
            done[at] = True
            matrix[at + 1, column + 1] = values[distance[at] + 1]
            added += values[distance[at] + 1]
            for k in range(starts[at], starts[at + 1]):
                other, reach = targets[k], distance[at] + costs[k]
                if done[other] or reach > depth or (distance[other] >= 0 and distance[other] <= reach):
                    continue
                distance[other] = reach
                if costs[k] == 0:
                    head -= 1
                    queue[head] = other
                else:
                    queue[tail] = other
                    tail += 1
        missing = total - values[0] - added
        if missing > 0:
            matrix[column + 1, column + 1] += missing
            added += missing
        if total < 1.0 and count > 1:
            spread = (1.0 - total) / (count - 1)
            for row in range(count):
                if matrix[row + 1, column + 1] == 0.0:
                    matrix[row + 1, column + 1] = spread
                    added += spread
        kept = 0.0
        for row in range(count):
            scaled = matrix[row + 1, column + 1] * (1.0 - values[0]) / added
            matrix[row + 1, column + 1] = scaled if scaled >= smallest else 0.0
            kept += matrix[row + 1, column + 1]
        matrix[0, column + 1] = 1.0 - kept
