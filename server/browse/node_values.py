"""A number for every node: what the 3D view can colour nodes by."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from server.errors import NotFoundError
from server.schemas import NodeValues, ValueNames
from slam.errors import DatabaseError

if TYPE_CHECKING:
    from server.browse.map_view import MapView
    from server.browse.snapshot import Snapshot

LOOPS, RESIDUAL, ALTITUDE = "loops", "residual", "altitude"
_UNITS = {LOOPS: "", RESIDUAL: "σ", ALTITUDE: "m"}
_SENSOR, _STATISTIC = "sensor:", "stat:"
#: Nodes, spread over the map, that tell which sensors there are.
_ASKED = 24
#: Stray values don't spoil the scale: it goes from this percentile to that one.
_LOW, _HIGH = 2.0, 98.0


class NodeNumbers:
    """Numbers of the nodes of one map by name; those of sensors are read once for each state of the file."""

    def __init__(self, view: MapView) -> None:
        self._view = view
        self._lock = threading.Lock()
        self._revision = -1
        self._sensors: dict[str, dict[int, float]] | None = None
        self._units: dict[str, str] | None = None

    def units(self) -> dict[str, str]:
        """Name -> unit of the sensors that some nodes have."""
        snapshot = self._view.snapshot()
        with self._lock:
            self._forget_if_changed(snapshot)
            if self._units is None:
                ids = snapshot.nodes.ids
                asked = (
                    ids[np.unique(np.linspace(0, len(ids) - 1, min(_ASKED, len(ids))).astype(int))] if len(ids) else ids
                )
                self._units = {name: unit for name, (_, unit) in self._read(asked.tolist()).items()}
            return self._units

    def of(self, name: str) -> Mapping[int, float]:
        """Id -> number, of the nodes that have one; raises NotFoundError for a name that the map doesn't have."""
        snapshot = self._view.snapshot()
        if name == LOOPS:
            return {i: float(snapshot.loop_counts[i]) for i in snapshot.rows}
        if name == RESIDUAL:
            return _residuals(snapshot)
        if name == ALTITUDE:
            return {i: fix.altitude for i, fix in snapshot.reader.gps().items()}
        if name.startswith(_SENSOR):
            return self._sensor(snapshot, name.removeprefix(_SENSOR))
        table, wanted = self._view.statistics.table(), name.removeprefix(_STATISTIC)
        if not name.startswith(_STATISTIC) or wanted not in table.values:
            raise NotFoundError(f"nodes of this map have no {name!r}")
        column = table.values[wanted]
        return {i: v for i, v in zip(table.ids.tolist(), column.tolist(), strict=True) if np.isfinite(v)}

    def _sensor(self, snapshot: Snapshot, name: str) -> Mapping[int, float]:
        with self._lock:
            self._forget_if_changed(snapshot)
            if self._sensors is None:
                self._sensors = {one: values for one, (values, _) in self._read(snapshot.nodes.ids.tolist()).items()}
            if name not in self._sensors:
                raise NotFoundError(f"nodes of this map have no sensor {name!r}")
            return self._sensors[name]

    def _forget_if_changed(self, snapshot: Snapshot) -> None:
        if snapshot.revision != self._revision:
            self._revision, self._sensors, self._units = snapshot.revision, None, None

    def _read(self, ids: list[int]) -> dict[str, tuple[dict[int, float], str]]:
        """Name -> values by id, and unit; a node whose sensors can't be read has none."""
        found: dict[str, tuple[dict[int, float], str]] = {}
        for node_id in ids:
            try:
                readings = self._view.reader.sensors(node_id).environment
            except DatabaseError:
                continue
            for one in readings:
                found.setdefault(one.name, ({}, one.unit))[0][node_id] = one.value
        return found


def scale(values: Mapping[int, float]) -> tuple[float, float]:
    """The ends of the scale of colours."""
    known = np.array([v for v in values.values() if np.isfinite(v)])
    return (float(np.percentile(known, _LOW)), float(np.percentile(known, _HIGH))) if len(known) else (0.0, 0.0)


def value_names(view: MapView) -> ValueNames:
    """What the nodes of this map can be coloured by."""
    sensors = [f"{_SENSOR}{name}" for name in sorted(view.node_numbers.units())]
    gps = [ALTITUDE] if view.snapshot().reader.gps() else []
    statistics = [f"{_STATISTIC}{name}" for name in view.statistics.names()]
    return ValueNames(names=[LOOPS, RESIDUAL, *gps, *sensors, *statistics])


def node_values(view: MapView, name: str) -> NodeValues:
    """The scale of one of them, and how many nodes have it."""
    values = view.node_numbers.of(name)
    low, high = scale(values)
    known = sum(i in view.snapshot().rows for i in values)
    unit = (
        view.node_numbers.units().get(name.removeprefix(_SENSOR), "")
        if name.startswith(_SENSOR)
        else _UNITS.get(name, "")
    )
    return NodeValues(name=name, unit=unit, low=low, high=high, known=known)


def _residuals(snapshot: Snapshot) -> dict[int, float]:
    """The worst residual of the links of each node, in sigmas."""
    found: dict[int, float] = {}
    for pair, sigma in snapshot.residuals.items():
        for node_id in pair:
            found[node_id] = max(sigma, found.get(node_id, 0.0))
    return found
