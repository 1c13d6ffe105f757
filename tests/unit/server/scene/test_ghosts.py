"""What another threshold would make of a map lies over it as ghosts."""

from __future__ import annotations

from typing import Any

import numpy as np

from server.browse.columns import pose_list
from server.browse.snapshot import Snapshot
from server.scene.colours import DARK
from server.scene.ghosts import GhostLayer, ghost_path, pairs_of
from server.scene.measure import Measure
from server.scene.placed import LinkKind, PlacedGraph
from server.schemas import LoopWhatIf, WhatIfGraph, WhatIfLoop
from slam.loop.foresight import Outcome
from tests.unit.server.scene.room_map import LOOPS, REFUSED

GOING = max(LOOPS), LOOPS[max(LOOPS)][0]


def foreseen(graph: PlacedGraph, moved_m: float) -> LoopWhatIf:
    """The refused loop comes, another one goes, and all nodes move along x."""
    T = graph.T_map.copy()
    T[:, 0, 3] += moved_m
    poses = [pose for pose in map(pose_list, T) if pose is not None]
    whole = WhatIfGraph(
        ids=graph.ids.tolist(),
        poses=poses,
        moved=len(T) if moved_m else 0,
        max_shift_m=moved_m,
        ate_m=None,
        stored_off_m=0.0,
    )
    loops = [
        WhatIfLoop(key=f"{a}-{b}", from_=a, to=b, value=0.5, outcome=outcome, inliers=None, reason="", true=None)
        for (a, b), outcome in ((REFUSED, Outcome.COMES), (GOING, Outcome.GOES))
    ]
    return LoopWhatIf(
        threshold=0.5,
        in_force=0.2,
        loops=loops,
        counts={},
        pending=0,
        precision=None,
        recall=None,
        ate_now_m=None,
        graph=whole,
    )


def test_coming_loops_have_gaps_going_ones_none_and_the_path_is_where_it_would_be(
    viewer: Any, snapshot: Snapshot
) -> None:
    graph = PlacedGraph.of(snapshot)
    layer, measure = GhostLayer(viewer.scene), Measure.of(graph.positions)
    layer.draw(graph, foreseen(graph, 0.5), measure, DARK, visible=True)
    coming, going, path = (viewer.scene.get_handle_by_name(f"/ghosts/{what}/0") for what in ("coming", "going", "path"))
    assert (np.linalg.norm(coming.points[:-1, 1] - coming.points[1:, 0], axis=1) > 0).all()
    np.testing.assert_array_equal(going.points[:-1, 1], going.points[1:, 0])
    np.testing.assert_allclose(path.points[0, 0], graph.positions[0] + (0.5, 0, 0), atol=1e-3)
    assert set(going.colors.ravel().tolist()) != set(coming.colors.ravel().tolist())
    layer.draw(graph, None, measure, DARK, visible=True)
    assert all(viewer.scene.get_handle_by_name(f"/ghosts/{what}/0") is None for what in ("coming", "going", "path"))


def test_a_path_that_would_not_move_is_no_ghost(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    assert len(ghost_path(graph, foreseen(graph, 0.0), 0.1)) == 0
    assert len(ghost_path(graph, foreseen(graph, 0.1), 0.1)) > 0


def test_loops_that_would_go_are_not_drawn_as_loops(snapshot: Snapshot) -> None:
    graph = PlacedGraph.of(snapshot)
    fewer = graph.without(pairs_of(foreseen(graph, 0.0), Outcome.GOES))
    loops = (LinkKind.LOOP, LinkKind.PROXIMITY, LinkKind.USER)
    assert sum(len(fewer.links[kind]) for kind in loops) == sum(len(graph.links[kind]) for kind in loops) - 1
    assert all({*fewer.pair_of(kind, index)} != set(GOING) for kind in loops for index in range(len(fewer.links[kind])))
