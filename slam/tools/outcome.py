"""What came of a run, read from its map file: numbers to compare it by, loops, poses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from slam.accuracy import pooled_ate_m
from slam.database import MapReader
from slam.geometry import Pose
from slam.graph.completion import completed
from slam.graph.graph import Pair, PoseGraph
from slam.tools.parameters import taken
from slam.types import WEIGHT_INTERMEDIATE, Link

_STM, _WM, _LTM = (f"Memory/{name}_memory_size/" for name in ("Short_time", "Working", "Long_term"))
_TIME = "Timing/Total/ms"
_RETRIEVED, _REMOVED = "Memory/Signatures_retrieved/", "Memory/Signatures_removed/"
_NAMES = (_STM, _WM, _LTM, _TIME, _RETRIEVED, _REMOVED)


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of a run; nodes go by the ids that they have in the map it is compared with.

    Attributes:
        nodes: number of ordinary nodes.
        sessions: number of sessions that have one.
        loops: the loops of the map by both ids, smaller first.
        refusals: why a pair that was tried is no loop, by both ids.
        ate_m: trajectory error of the nodes, metres; None without ground truth.
        path_m: length of the optimised path, sessions added up.
        update_ms: (N,) time of the updates; NaN where it was not stored.
        wm: (N,) nodes in working memory after them; likewise.
        ids: (N,) nodes of these updates, ascending.
        stm_max: most nodes in short-term memory; None where the file does not say, as for the next three.
        ltm_end: nodes in long-term memory at the end.
        retrieved: nodes that came back from there, counted each time.
        transferred: nodes that went there, counted each time.
        poses: ``T_map_base`` by id.
    """

    nodes: int
    sessions: int
    loops: Mapping[Pair, Link]
    refusals: Mapping[Pair, str]
    ate_m: float | None
    path_m: float
    ids: NDArray[np.int64]
    update_ms: NDArray[np.float64]
    wm: NDArray[np.float64]
    stm_max: int | None
    ltm_end: int | None
    retrieved: int | None
    transferred: int | None
    poses: Mapping[int, Pose]

    @property
    def loop_counts(self) -> Counter[str]:
        """Number of loops by the name of their type."""
        return Counter(link.type.label for link in self.loops.values())


def outcome(reader: MapReader, old_ids: Mapping[int, int]) -> Outcome:
    """What came of the run that made a map file.

    Args:
        reader: of the file.
        old_ids: its nodes -> nodes of the map that it is compared with; others are left out.

    Raises:
        DatabaseError: the file can't be read.
        OptimizationError: poses that it lacks can't be worked out.
    """
    table = reader.nodes()
    rows = np.flatnonzero((table.weights > WEIGHT_INTERMEDIATE) & np.isin(table.ids, list(old_ids)))
    ids, map_ids = table.ids[rows].tolist(), table.map_ids[rows]
    names = {i: old_ids[i] for i in ids}
    poses, links = _poses(reader), reader.links()
    placed = [k for k, i in enumerate(ids) if i in poses]
    T_map = np.array([poses[ids[k]] for k in placed]).reshape(-1, 4, 4)
    pairs = [link.pair for link in links if link.to_id > 0]
    loops = {_named(link.pair, names): link for link in links if link.type.is_loop and set(link.pair) <= names.keys()}
    curves = reader.statistics(names=_NAMES)
    known = [k for k, i in enumerate(curves.ids.tolist()) if i in names]
    columns = {name: _column(curves.values, name, len(curves.ids))[known] for name in _NAMES}
    return Outcome(
        nodes=len(ids),
        sessions=len(np.unique(map_ids)),
        loops=loops,
        refusals=_refusals(reader, names, loops),
        ate_m=pooled_ate_m(table.T_world[rows][placed], T_map, np.array(ids, np.int64)[placed], pairs),
        path_m=_length(T_map[:, :3, 3], map_ids[placed]),
        ids=np.array([names[i] for i in curves.ids[known].tolist()], np.int64),
        update_ms=columns[_TIME],
        wm=columns[_WM],
        stm_max=_whole(columns[_STM], np.max),
        ltm_end=_whole(columns[_LTM], lambda values: values[-1]),
        retrieved=_whole(columns[_RETRIEVED], np.sum),
        transferred=_whole(columns[_REMOVED], np.sum),
        poses={names[i]: poses[i] for i in ids if i in poses},
    )


def _poses(reader: MapReader) -> dict[int, Pose]:
    """Optimised poses; those that the file lacks as links tell them."""
    stored, graph = reader.poses(), PoseGraph.from_reader(reader)
    if graph.poses.keys() <= stored.keys():
        return stored
    return graph.poses | completed(graph, stored, taken(reader).params) | stored


def _refusals(reader: MapReader, names: Mapping[int, int], loops: Mapping[Pair, Link]) -> dict[Pair, str]:
    """The last word about each pair that was tried and is no loop."""
    found = {}
    for row in reader.candidates():
        tried = row.candidate
        if tried.from_id in names and tried.to_id in names:
            why = "a decision took it out" if tried.refusal is None else tried.refusal.text
            found[_named((tried.from_id, tried.to_id), names)] = why
    return {pair: why for pair, why in found.items() if pair not in loops}


def _named(pair: Pair, names: Mapping[int, int]) -> Pair:
    a, b = names[pair[0]], names[pair[1]]
    return min(a, b), max(a, b)


def _length(positions: NDArray[np.float64], map_ids: NDArray[np.int32]) -> float:
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    return float(steps[map_ids[1:] == map_ids[:-1]].sum())


def _column(values: Mapping[str, NDArray[np.float64]], name: str, rows: int) -> NDArray[np.float64]:
    return values[name] if name in values else np.full(rows, np.nan)


def _whole(values: NDArray[np.float64], of: Callable[[NDArray[np.float64]], float]) -> int | None:
    known = values[np.isfinite(values)]
    return int(of(known)) if len(known) else None
