"""A loop that is found to be wrong later leaves the graph and the file, and both say so."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

from slam.database import MapReader, MapWriter
from slam.graph import PoseGraph
from slam.graph.graph import Pair
from slam.loop.closing import Closed, LoopCloser
from slam.loop.repair import taken_back
from slam.params import Params
from slam.slam import Slam
from slam.types import Candidate
from tests.tours import EVERY, fed, sparse

_REMOVED = "Loop/Optimization_max_error_removed_{}/"


class Doubting(LoopCloser):
    """Takes back the oldest loop whenever a new one comes."""

    asked: set[Pair]

    def close(
        self,
        graph: PoseGraph,
        candidates: Sequence[Candidate],
        params: Params,
        kept: Callable[[], Collection[Pair]] = tuple,
    ) -> Closed:
        old = [graph.links[pair] for pair in sorted(graph.links) if graph.links[pair].type.is_loop]
        closed = super().close(graph, candidates, params)
        if not closed.links or not old:
            return closed
        self.asked = set(kept())
        graph.remove_link(old[0].pair)
        gone = taken_back(old[0], old[0], params)
        return replace(closed, removed=(old[0],), candidates=(*closed.candidates, gone))


def test_a_loop_that_is_taken_back_leaves_graph_and_file(tmp_path: Path) -> None:
    params = EVERY.changed({"Rtabmap/MemoryThr": 25})
    slam = Slam(params, MapWriter.create(tmp_path / "map.db", params, seed=0, source="tour:"))
    slam._closer = doubting = Doubting()
    updates = fed(slam, sparse())
    slam.close()
    reader = MapReader(tmp_path / "map.db")
    gone = [c for u in updates for c in u.candidates if c.refusal and c.refusal.test.endswith("RepairRadius")]
    assert len(gone) > 1
    assert {link.pair for link in reader.links() if link.from_id != link.to_id} == set(slam.graph.links)
    assert not {(c.to_id, c.from_id) for c in gone} & set(slam.graph.links)
    told = [u.statistics for u in updates if _REMOVED.format("count") in u.statistics]
    assert [t[_REMOVED.format("from_id")] for t in told] == [float(c.from_id) for c in gone]
    assert {t[_REMOVED.format("count")] for t in told} == {1.0}
    assert sum(row.candidate.refusal == gone[0].refusal for row in reader.candidates()) == len(gone)
    assert doubting.asked == set()
