"""Local grids made anew, of depth images and with other parameters: the floor plan that comes of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from slam.database import GridChange, JournalEntry, MapReader, SettingChange
from slam.edit.choice import require_session
from slam.edit.job import Job, JobStep
from slam.edit.wishes import Regrid
from slam.errors import DatabaseError, DecisionError, SourceError
from slam.geometry import Pose
from slam.graph.graph import PoseGraph
from slam.maps.local_grid import level, make_local_grid
from slam.maps.views import node_depths
from slam.params import Params, format_value
from slam.review import Review
from slam.types import LocalGrid

_CELL_SIZE = "Grid/CellSize"
#: Kinds of cells of one place, of which the first that any camera saw holds.
_KINDS = ("obstacles", "ground", "empty")


def regrid(review: Review, reader: MapReader, wanted: Regrid, author: str = "") -> Job:
    """Make local grids anew as one decision, which one undo takes back; nodes without depth keep theirs, and are named.

    Grids of a map have cells of one size, and so do those of its next session: another ``Grid/CellSize`` goes into the
    parameters of the map with them.

    Raises:
        DecisionError: the parameters are not of local grids, no node is like that, or grids of another cell size
            would stay.
        DatabaseError: it can't be written.
    """
    params, nodes = changed(review.params, wanted), _chosen(review.graph, wanted)
    _require_one_size(review, reader, params, nodes)
    made: dict[int, LocalGrid] = {}
    for number, node_id in enumerate(nodes, 1):
        try:
            made[node_id] = remade(reader, node_id, review.graph.poses[node_id], params)
            text = told(made[node_id])
        except (DatabaseError, SourceError) as error:
            text = f"stays as it is: {error}"
        yield JobStep(number / (len(nodes) + 1), f"node {node_id}: {text}")
    yield JobStep(1.0, f"{len(made)} of {len(nodes)} local grids made anew")
    return review.change([_entry(review.params, wanted, made, author)]) if made else None


def changed(params: Params, wanted: Regrid) -> Params:
    """The parameters that grids are made with; raises DecisionError or ParameterError for changes that can't be."""
    others = [name for name in wanted.changes if not name.startswith("Grid/")]
    if others:
        raise DecisionError(f"{', '.join(others)}: only parameters of the group Grid/ change a local grid")
    return params.changed(wanted.changes)


def remade(reader: MapReader, node_id: int, T_map_base: Pose, params: Params) -> LocalGrid:
    """The local grid that these parameters make of a node's depth.

    Raises:
        DatabaseError: it has no depth or no calibration, or they are damaged.
        SourceError: the images of a stereo pair don't fit each other.
    """
    T_level_base = level(T_map_base)
    return merged(
        [
            make_local_grid(depth_m, camera.at_size(depth_m.shape[1], depth_m.shape[0]), T_level_base, params)
            for depth_m, camera in node_depths(reader, node_id)
        ]
    )


def merged(grids: Sequence[LocalGrid]) -> LocalGrid:
    """What several cameras of a node saw, as one grid: what one holds for an obstacle is no ground of another."""
    if len(grids) == 1:
        return grids[0]
    size, taken = grids[0].cell_size, set[tuple[int, int]]()
    found = {}
    for kind in _KINDS:
        cells = {cell for grid in grids for cell in _cells(getattr(grid, kind), size)} - taken
        taken |= cells
        centres = (np.array(sorted(cells), np.float64).reshape(-1, 2) + 0.5) * size
        found[kind] = centres.astype(np.float32)
    return LocalGrid(found["ground"], found["obstacles"], found["empty"], size, grids[0].view_point)


def told(grid: LocalGrid) -> str:
    """How many cells it has."""
    return f"{len(grid.ground)} ground, {len(grid.obstacles)} obstacle, {len(grid.empty)} empty"


def _cells(centres: NDArray[np.float32], size: float) -> Iterable[tuple[int, int]]:
    return ((int(x), int(y)) for x, y in np.floor(centres / size).tolist())


def _chosen(graph: PoseGraph, wanted: Regrid) -> list[int]:
    require_session(graph, wanted.session)
    found = [
        node_id
        for node_id in sorted(graph.poses)
        if node_id >= max(1, wanted.first)
        and (not wanted.last or node_id <= wanted.last)
        and (wanted.session < 0 or graph.map_ids[node_id] == wanted.session)
    ]
    if not found:
        raise DecisionError("no node is of these ids and this session: no local grid would be made")
    return found


def _require_one_size(review: Review, reader: MapReader, params: Params, nodes: Sequence[int]) -> None:
    before, after = review.params.Grid.CellSize, params.Grid.CellSize
    if after == before:
        return
    can = set(nodes) & set(reader.nodes_with("depth").tolist())
    left = [i for i in reader.nodes_with_grid().tolist() if i in review.graph and i not in can]
    if left:
        raise DecisionError(
            f"{_CELL_SIZE} {after:g}: {len(left)} nodes, {left[0]} among them, would keep cells of {before:g} m. Make"
            " the grids of all nodes anew, or leave the size"
        )


def _entry(params: Params, wanted: Regrid, made: dict[int, LocalGrid], author: str) -> JournalEntry:
    said = ", ".join(f"{name} {format_value(value)}" for name, value in sorted(wanted.changes.items()))
    first, last = min(made), max(made)
    size = wanted.changes.get(_CELL_SIZE)
    before = format_value(params.Grid.CellSize)
    return JournalEntry(
        action="regrid",
        from_id=first,
        to_id=last,
        author=author,
        note=(f"node {first}" if first == last else f"{len(made)} nodes") + (f": {said}" if said else ""),
        setting=None
        if size is None or format_value(size) == before
        else SettingChange(_CELL_SIZE, before, format_value(size)),
        grids=GridChange(nodes=len(made), made=made),
    )
