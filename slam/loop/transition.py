"""How likely the robot goes from each place to each other one between two updates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slam.graph.graph import PoseGraph
from slam.params import Params
from slam.types import LinkType

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
#: What a place is linked with: id and cost, 0 within a place, 1 to a neighbour.
Beside = tuple[tuple[int, int], ...]
STEP = (LinkType.NEIGHBOR, LinkType.NEIGHBOR_MERGED)
#: Links that tie two nodes to one place; proximity links aren't followed.
_SAME_PLACE = (LinkType.GLOBAL_CLOSURE, LinkType.USER_CLOSURE)


class Transition:
    """The matrix of the last update, of which only what changed is worked out again."""

    def __init__(self) -> None:
        self._beside: dict[int, Beside] = {}
        # Has spare rows and columns, all 0, so that a new place costs no copy of it.
        self._room: Array = np.zeros((1, 1))
        self._prediction = ""

    def update(self, ids: Sequence[int], graph: PoseGraph, params: Params) -> Array:
        """(N + 1, N + 1) probabilities of going from a column's place to a row's; index 0 is the virtual place.

        What it gives is good until the next call.

        Each column sums to one. A column changes when something within the reach of ``Bayes/PredictionLC`` does, or
        with the number of places where that sums to less than one; ``Bayes/FullPredictionUpdate`` works out all of
        them, which gives the same.
        """
        text = params.Bayes.PredictionLC
        values = np.array([float(v) for v in text.split()])
        beside = _beside(ids, graph)
        if params.Bayes.FullPredictionUpdate or text != self._prediction or values.sum() < 1.0:
            stale, self._beside, self._room = set(ids), {}, np.zeros((len(ids) + 1, len(ids) + 1))
        else:
            changed = {i for i in beside.keys() | self._beside.keys() if beside.get(i) != self._beside.get(i)}
            reach = len(values) - 2
            stale = _near(changed, beside, reach) | _near(changed, self._beside, reach)
        matrix = self._kept(ids, stale)
        rows = {node_id: row for row, node_id in enumerate(ids)}
        columns = np.array([rows[i] for i in ids if i in stale], np.int32)
        _fill(matrix, columns, *_columns(ids, beside, rows), values)
        stay = params.Bayes.VirtualPlacePriorThr
        matrix[0, 0] = stay if len(ids) else 1.0
        matrix[1:, 0] = (1.0 - stay) / len(ids) if len(ids) else 0.0
        self._beside, self._prediction = beside, text
        return matrix

    def _kept(self, ids: Sequence[int], stale: set[int]) -> Array:
        """A matrix for these ids with the columns that are still right, the others 0."""
        size, old = len(ids) + 1, list(self._beside)
        if list(ids[: len(old)]) != old:
            self._room = self._moved(ids, old)
        elif size > len(self._room):
            grown = np.zeros((2 * size, 2 * size))
            grown[: len(old) + 1, : len(old) + 1] = self._room[: len(old) + 1, : len(old) + 1]
            self._room = grown
        matrix = self._room[:size, :size]
        for row, node_id in enumerate(ids):
            if node_id in stale:
                matrix[:, row + 1] = 0.0
        return matrix

    def _moved(self, ids: Sequence[int], old: Sequence[int]) -> Array:
        """Room with what both have where it is now: places have left since, or came back between others."""
        before = {node_id: row + 1 for row, node_id in enumerate(old)}
        now = [0, *(row + 1 for row, node_id in enumerate(ids) if node_id in before)]
        then = [0, *(before[node_id] for node_id in ids if node_id in before)]
        room = np.zeros((len(ids) + 1, len(ids) + 1))
        room[np.ix_(now, now)] = self._room[np.ix_(then, then)]
        return room


def _beside(ids: Sequence[int], graph: PoseGraph) -> dict[int, Beside]:
    """What each of ``ids`` is linked with among them, in their order."""
    known, found = set(ids), {}
    for node_id in ids:
        links = ((other, link.type) for other, link in graph.places_beside(node_id) if other in known)
        found[node_id] = tuple(
            (other, int(kind in STEP)) for other, kind in links if kind in _SAME_PLACE or kind in STEP
        )
    return found


def _near(changed: Iterable[int], beside: Mapping[int, Beside], reach: int) -> set[int]:
    """Ids within so many steps of those that changed."""
    best = dict.fromkeys((i for i in changed if i in beside), 0)
    level = list(best)
    for distance in range(reach + 1):
        following: list[int] = []
        stack = [i for i in level if best[i] == distance]
        while stack:
            for other, cost in beside[stack.pop()]:
                if best.get(other, reach + 1) > distance + cost:
                    best[other] = distance + cost
                    (following if cost else stack).append(other)
        level = following
    return set(best)


def _columns(ids: Sequence[int], beside: Mapping[int, Beside], rows: Mapping[int, int]) -> tuple[Ints, Ints, Ints]:
    """Links among ``ids`` as starts (N + 1,), targets and costs."""
    starts = np.cumsum([0, *(len(beside[i]) for i in ids)])
    flat = [(rows[other], cost) for i in ids for other, cost in beside[i]]
    targets, costs = np.array(flat, np.int32).reshape(-1, 2).T
    return starts.astype(np.int32), np.ascontiguousarray(targets), np.ascontiguousarray(costs)


@njit(cache=True, nogil=True)
def _fill(matrix: Array, columns: Ints, starts: Ints, targets: Ints, costs: Ints, values: Array) -> None:
    """These columns of real places: ``values`` by graph distance, what is missing goes to staying, then normalised."""
    count = len(starts) - 1
    depth = len(values) - 2
    smallest = values.min()
    total = values.sum()
    distance = np.full(count, -1, np.int32)
    queue = np.empty(2 * (count + len(targets)) + 2, np.int32)
    for column in columns:
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
