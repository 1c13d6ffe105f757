"""Statistics over a map's updates, and the belief over places of one of them."""

from __future__ import annotations

import threading
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from server.browse.columns import number_list
from server.errors import NotFoundError
from server.schemas import Hypothesis, Statistics
from slam.database import Faults, MapReader, StatisticsTable


class StatisticsLog:
    """All statistics of a map in memory; each update is read once, what comes later is appended.

    Attributes:
        faults: rows that make no sense, of what was read so far.
    """

    def __init__(self, reader: MapReader) -> None:
        self._reader = reader
        self._lock = threading.Lock()
        self._ids = np.zeros(0, dtype=np.int32)
        self._stamps = np.zeros(0)
        self._values: dict[str, NDArray[np.float64]] = {}
        self.faults: Faults = {}

    def names(self) -> list[str]:
        """All names, sorted."""
        with self._lock:
            self._read_on()
            return sorted(self._values)

    def columns(self, names: Sequence[str], after: int) -> Statistics:
        """The updates after node ``after``; a name that the map doesn't have is a column of nothing."""
        with self._lock:
            self._read_on()
            start = int(np.searchsorted(self._ids, after, side="right"))
            return Statistics(
                ids=self._ids[start:].tolist(),
                stamps=self._stamps[start:].tolist(),
                values={name: number_list(self._column(name)[start:]) for name in names},
            )

    def table(self) -> StatisticsTable:
        """All updates with all they measured."""
        with self._lock:
            self._read_on()
            return StatisticsTable(ids=self._ids, stamps=self._stamps, values=self._values)

    def _column(self, name: str) -> NDArray[np.float64]:
        return self._values.get(name, np.full(len(self._ids), np.nan))

    def _read_on(self) -> None:
        new = self._reader.statistics(after=int(self._ids[-1]) if len(self._ids) else 0, faults=self.faults)
        if not len(new.ids):
            return
        unknown = np.full(len(new.ids), np.nan)
        self._values = {
            name: np.concatenate([self._column(name), new.values.get(name, unknown)])
            for name in self._values.keys() | new.values.keys()
        }
        self._ids = np.concatenate([self._ids, new.ids])
        self._stamps = np.concatenate([self._stamps, new.stamps])


def values_at(reader: MapReader, node_id: int, faults: Faults) -> dict[str, float]:
    """What the update of a node measured; empty when it has no statistics, or such as make no sense."""
    table = reader.statistics([node_id], faults=faults)
    if not len(table.ids):
        return {}
    found = {name: float(column[0]) for name, column in table.values.items()}
    return {name: value for name, value in found.items() if np.isfinite(value)}


def hypothesis(reader: MapReader, update_id: int) -> Hypothesis:
    """The best places of an update's belief; raises NotFoundError where it had none."""
    belief = reader.hypotheses(update_id)
    if belief is None:
        raise NotFoundError(f"node {update_id} has no loop hypotheses: its update computed none, or did not store them")
    return Hypothesis(
        ids=belief.node_ids.tolist(),
        likelihood=belief.likelihood.tolist(),
        posterior=belief.probability.tolist(),
        virtual_place=belief.virtual_place,
        value=belief.value,
    )
