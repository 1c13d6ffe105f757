"""One served map: notices changes of its file and keeps what was read as long as it holds."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from server.browse.asked import Asked
from server.browse.beliefs import BeliefLog
from server.browse.grid_then import GridThen
from server.browse.increments import Increments
from server.browse.moves import Move, moves_of_states
from server.browse.node_values import NodeNumbers
from server.browse.optimising import Optimisations
from server.browse.past import Past
from server.browse.pixels import Pixels
from server.browse.snapshot import Snapshot
from server.browse.statistics import StatisticsLog
from server.browse.tiers import TierLog
from server.browse.timeline import Timeline
from server.browse.trials import LoopTrials
from server.browse.what_if import WhatIfs
from server.catalog import MapFile
from slam.database import Faults, MapReader, StatisticsTable
from slam.types import Candidate, OccupancyGrid

Fingerprint = tuple[tuple[int, int], ...]


class MapView:
    """Reads one map file for any number of threads.

    Attributes:
        file: which one.
        reader: of the file.
        asked: who waits for an answer about it.
        increments: what changed in the graph since which revision.
        statistics: of its updates.
        trials: what the images say of loops that were never tried.
        pixels: depth of single pixels.
        what_ifs: what another ``Rtabmap/LoopThr`` would mean.
        optimisations: of its graph, looked at and not stored.
        node_numbers: what nodes can be coloured by.
    """

    def __init__(self, file: MapFile) -> None:
        self.file = file
        self.reader = MapReader(file.path)
        self.asked = Asked()
        self.increments = Increments()
        self.statistics = StatisticsLog(self.reader)
        self.trials = LoopTrials(self.reader)
        self.pixels = Pixels(self.reader)
        self.what_ifs = WhatIfs(self)
        self.optimisations = Optimisations()
        self.node_numbers = NodeNumbers(self)
        self._tiers = TierLog(self.reader)
        self._beliefs = BeliefLog(self.reader)
        self._lock = threading.Lock()
        self._print: Fingerprint = ()
        self._revision = 0
        self._snapshot: Snapshot | None = None
        self._timeline: Timeline | None = None
        self._past: Past | None = None
        self._grids: GridThen | None = None
        self._grids_made = 0
        # How many updates slamdeck did not make, and what moved in them.
        self._earlier: tuple[int, Sequence[Move]] = (0, ())
        # Of updates, which are read once.
        self._faults: Faults = {}

    @property
    def revision(self) -> int:
        """What the file was last read as, or will be read as where somebody said that it changed."""
        return self._revision

    def snapshot(self) -> Snapshot:
        """What the file holds now."""
        with self._lock:
            # Taken before the file is read: what is written meanwhile is noticed the next time.
            now = _fingerprint(self.file.path)
            known = self._snapshot
            if known is not None and now == self._print and known.revision == self._revision:
                return known
            if known is None or known.revision == self._revision:
                self._revision += 1
            self._snapshot = Snapshot(
                self.reader,
                self._revision,
                self._tiers.read(self._faults),
                self._faults,
                self._beliefs,
                self.statistics,
            )
            self._print = now
            return self._snapshot

    def tried(self, pairs: Iterable[tuple[int, int]]) -> tuple[Candidate, ...]:
        """Those of these loops that only the what-if has looked at."""
        done, wanted = self.trials.done(self.snapshot().params), {(min(pair), max(pair)) for pair in pairs}
        return tuple(candidate for pair, candidate in done.items() if pair in wanted)

    def timeline(self) -> Timeline:
        """The updates that led to what the file holds now."""
        snapshot, known = self.snapshot(), self._timeline
        if known is not None and known.snapshot is snapshot:
            return known
        with self._lock:
            recorded = self._tiers.moves()
        measured = self.statistics.table()
        made = Timeline(snapshot, [*self._earlier_moves(measured, recorded), *recorded], measured)
        self._timeline = made
        return made

    def past(self) -> Past:
        """The moments of that timeline."""
        timeline = self.timeline()
        if self._past is None or self._past.timeline is not timeline:
            self._past = Past(timeline, self._local_grids(timeline.snapshot))
        return self._past

    def assembled(self, seconds: float, *, probable: bool = False) -> tuple[OccupancyGrid | None, bool]:
        """The floor plan of the local grids at the poses of now; ``probable`` with the probability of each cell.

        Returns:
            What is put together within this time and before, and whether that is all.
        """
        snapshot = self.snapshot()
        nodes = [i for i in self.reader.nodes_with_grid().tolist() if i in snapshot.rows]
        return self._local_grids(snapshot).at(
            (snapshot.revision,), nodes, len(nodes), snapshot.poses, seconds, probable=probable
        )

    def _local_grids(self, snapshot: Snapshot) -> GridThen:
        """Read anew when a decision has made some anew, or has taken that back."""
        made = max((entry.id for entry in snapshot.journal if entry.grids is not None), default=0)
        if self._grids is None or self._grids_made != made:
            self._grids, self._grids_made = GridThen(self.reader, snapshot.params), made
        return self._grids

    def _earlier_moves(self, measured: StatisticsTable, recorded: Sequence[Move]) -> Sequence[Move]:
        """Moves of updates that slamdeck did not make; read anew only when there are more of them."""
        before = recorded[0].id if recorded else None
        rows = len(measured.ids) if before is None else int(np.searchsorted(measured.ids, before))
        with self._lock:
            if self._earlier[0] != rows:
                self._earlier = rows, tuple(moves_of_states(self.reader, measured, before, self._faults))
            return self._earlier[1]

    def touch(self) -> int:
        """Somebody wrote the file, perhaps so soon after the last time that its clock does not show it.

        Returns:
            The revision of the next snapshot.
        """
        with self._lock:
            self._revision += 1
            return self._revision

    def grid_written(self) -> None:
        """The floor plan was written, and nothing that a snapshot holds."""
        with self._lock:
            if self._snapshot is not None and self._snapshot.revision == self._revision:
                self._print = _fingerprint(self.file.path)


def _fingerprint(path: Path) -> Fingerprint:
    found = []
    for part in (path, path.with_name(path.name + "-wal")):
        try:
            state = part.stat()
        except FileNotFoundError:
            continue
        found.append((state.st_mtime_ns, state.st_size))
    return tuple(found)
