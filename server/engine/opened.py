"""A map file, open for people's decisions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from server.browse.snapshot import Snapshot
from slam.database import MapReader, MapWriter
from slam.graph.graph import PoseGraph
from slam.maps.grid_rebuild import GridRebuild
from slam.params import Params
from slam.review import Review


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """What works on it; ``grid`` makes the floor plan anew when it is told to."""

    writer: MapWriter
    reader: MapReader
    params: Params
    review: Review
    grid: GridRebuild


@contextmanager
def opened(path: Path, params: Params | None = None) -> Iterator[Opened]:
    """Open a map for decisions, with its own parameters or others; afterwards it is one plain file again.

    Raises:
        DatabaseError: it is no map, or can't be written.
        MapBusyError: somebody else writes it.
    """
    with MapWriter.open(path) as writer:
        reader = MapReader(path)
        snapshot = Snapshot(reader, 1, {})
        chosen = snapshot.params if params is None else params
        graph = PoseGraph.from_reader(reader)
        # Where the file lacks poses, those that the page shows.
        graph.poses |= {i: T for i, T in snapshot.graph.poses.items() if i in graph}
        review = Review(graph, writer, reader, chosen, lambda poses: snapshot.truth.ate_at(poses, graph.links))
        yield Opened(writer, reader, chosen, review, GridRebuild(reader, writer, graph, chosen))
