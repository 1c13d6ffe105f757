"""An old false loop that keeps true ones out goes, with its neighbours, and never what somebody has approved."""

from __future__ import annotations

import numpy as np

from slam.geometry import Pose, between, make
from slam.graph import PoseGraph
from slam.graph.optimizer import optimize
from slam.graph.verify import close_loops
from slam.loop.closing import Closed, LoopCloser
from slam.params import Params
from slam.types import Candidate, Link, LinkType
from tests.graphs import INFORMATION, LAP, circles, stacked, truth

REPAIRING = Params().changed({"RGBD/OptimizeMaxErrorRepairRadius": 0.5})
TRUE = truth(60)
FALSE = (30, 50)


def measured(new: int, T_error: Pose | None = None) -> Pose:
    """The true transform to the node one lap before, or one with an error."""
    T = between(TRUE[new - 1], TRUE[new - LAP - 1])
    return T if T_error is None else np.asarray(T @ T_error)


def shifted(metres: float) -> Pose:
    return make(np.eye(3), np.array([metres, 0.0, 0.0]))


def misled(*, type_: LinkType = LinkType.GLOBAL_CLOSURE) -> PoseGraph:
    """Circles whose graph took in a loop that is 30 cm wrong: alone, odometry could live with it."""
    graph = circles(60, 1)
    link = Link(50, 30, type_, measured(50, shifted(0.3)), INFORMATION)
    assert close_loops(graph, [link], Params()).accepted
    return graph


def offered(new: int, T_error: Pose | None = None) -> list[Candidate]:
    return [Candidate(new, new - LAP, LinkType.GLOBAL_CLOSURE, 0.5, 90, 60, measured(new, T_error), INFORMATION, None)]


def closed_after(graph: PoseGraph, params: Params, kept: tuple[tuple[int, int], ...] = ()) -> list[Closed]:
    closer = LoopCloser()
    return [closer.close(graph, offered(new), params, lambda: kept) for new in (52, 48, 54)]


def test_the_second_time_it_is_blamed_it_goes_and_the_map_is_right() -> None:
    graph, never = misled(), circles(60, 1)
    first, second, third = closed_after(graph, REPAIRING)
    assert [link.pair for link in first.blamed] == [FALSE]
    assert first.removed == first.links == ()
    assert [link.pair for link in second.removed] == [FALSE]
    assert [link.pair for link in second.links] == [(28, 48)]
    gone = second.candidates[-1]
    assert (gone.from_id, gone.to_id) == (50, 30)
    assert gone.refusal is not None
    assert gone.refusal.test == "RGBD/OptimizeMaxErrorRepairRadius"
    assert [link.pair for link in third.links] == [(34, 54)]
    assert FALSE not in graph.links
    LoopCloser().close(never, offered(48) + offered(54), REPAIRING)
    np.testing.assert_allclose(stacked(graph.poses), stacked(never.poses), atol=1e-4)


def test_without_a_radius_nothing_goes() -> None:
    graph = misled()
    assert [one.removed for one in closed_after(graph, Params())] == [(), (), ()]
    assert FALSE in graph.links


def test_what_somebody_approved_or_made_stays() -> None:
    for graph, kept in ((misled(), (FALSE,)), (misled(type_=LinkType.USER_CLOSURE), ())):
        assert [one.removed for one in closed_after(graph, REPAIRING, kept)] == [(), (), ()]
        assert FALSE in graph.links


def test_loops_that_end_near_it_go_with_it() -> None:
    graph = misled()
    near, far = (
        Link(new, new - LAP, LinkType.LOCAL_SPACE_CLOSURE, measured(new), 1e-3 * INFORMATION) for new in (51, 40)
    )
    assert close_loops(graph, [near, far], Params()).accepted
    _, second, _ = closed_after(graph, REPAIRING)
    assert {link.pair for link in second.removed} == {FALSE, near.pair}
    assert [c.refusal is None for c in second.candidates] == [True, False, False]
    assert far.pair in graph.links


def test_a_repair_that_lets_nothing_in_is_taken_back() -> None:
    graph, closer = misled(), LoopCloser()
    # Another false loop, out of reach of the first, which keeps the true one out as well.
    graph.add_link(Link(44, 24, LinkType.GLOBAL_CLOSURE, measured(44, shifted(0.3)), INFORMATION))
    graph.poses = optimize(graph, Params()).poses
    links, poses = dict(graph.links), stacked(graph.poses)
    for _ in range(2):
        closed = closer.close(graph, offered(47), REPAIRING)
        assert [link.pair for link in closed.blamed] == [FALSE]
        assert closed.links == closed.removed == ()
    assert graph.links == links
    np.testing.assert_array_equal(stacked(graph.poses), poses)
