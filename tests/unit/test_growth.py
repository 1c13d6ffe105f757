"""A large map with little memory: what an update works on stays small, and places that left RAM are recognised."""

from __future__ import annotations

from functools import cache

import numpy as np

from slam.geometry import between, make, translation_norm
from slam.graph.verify import residual_ratios
from slam.params import Params
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import Link, LinkType, Update
from tests.ghosts import GhostOdometry, GhostWorld
from tests.graphs import INFORMATION

PLACES, ROOM, FRAMES = 60, 24, 140
PARAMS = Params().changed({"Rtabmap/DetectionRate": 0.0, "RGBD/CreateOccupancyGrid": False})


@cache
def laps(room: int) -> tuple[Slam, tuple[Update, ...]]:
    """More than two laps of a street of 60 places, with this much room in working memory."""
    world = GhostWorld(PLACES)
    slam = Slam(PARAMS.changed({"Rtabmap/MemoryThr": room}))
    slam._odometry = GhostOdometry(world)  # type: ignore[assignment]
    return slam, tuple(slam.process(frame) for frame in world.frames(FRAMES))


def is_true(from_id: int, to_id: int) -> bool:
    """Whether two nodes are at the same place or one of the next two."""
    apart = (from_id - to_id) % PLACES
    return min(apart, PLACES - apart) <= 2


def joined(updates: tuple[Update, ...]) -> list[tuple[int, int]]:
    """The pairs of nodes of accepted loops."""
    return [(c.from_id, c.to_id) for update in updates for c in update.candidates if c.refusal is None]


def test_what_is_worked_on_does_not_grow_with_the_map() -> None:
    slam, updates = laps(ROOM)
    for update in updates[60:]:
        assert update.statistics["Memory/Local_graph_size/"] < 2 * ROOM
    assert len(slam.graph) == FRAMES
    assert len(slam._active.graph.links) < 3 * (ROOM + 11)


def test_no_true_loop_is_lost_that_retrieval_should_have_saved() -> None:
    everything, little = joined(laps(0)[1]), joined(laps(ROOM)[1])
    assert all(is_true(*pair) for pair in everything + little)
    again = {new for new, _ in everything}
    assert len(again) > 0.85 * (FRAMES - PLACES)
    assert len(again - {new for new, _ in little}) <= 0.05 * len(again)


def test_poses_are_as_good_with_little_memory() -> None:
    slam, _ = laps(ROOM)
    error, best = ate_rmse_m(slam), ate_rmse_m(laps(0)[0])
    assert error is not None
    assert best is not None
    assert error < 1.5 * best + 0.02


def test_links_join_places_that_are_one() -> None:
    slam, _ = laps(ROOM)
    world = GhostWorld(PLACES)
    for link in slam.graph.links.values():
        true = between(world.T_world_base(link.from_id - 1), world.T_world_base(link.to_id - 1))
        assert link.T_from_to is not None
        assert translation_norm(between(true, link.T_from_to)) < 0.3
    assert np.isfinite(list(slam.graph.poses.values())).all()


@cache
def many_laps() -> tuple[Slam, tuple[Update, ...]]:
    """Seven laps of a street of 15 places, with room for six nodes beside the newest ones."""
    world = GhostWorld(15)
    slam = Slam(PARAMS.changed({"Rtabmap/MemoryThr": 6}))
    slam._odometry = GhostOdometry(world)  # type: ignore[assignment]
    return slam, tuple(slam.process(frame) for frame in world.frames(105))


def test_after_many_laps_loops_are_closed_as_ever_and_all_copies_of_a_place_agree() -> None:
    slam, updates = many_laps()
    late = joined(updates[-30:])
    assert len({new for new, _ in late}) >= 29
    assert all((new - old) % 15 == 0 for new, old in late)
    ratios = residual_ratios(list(slam.graph.links.values()), slam.graph.poses)[:, [0, 2]]
    assert np.sqrt((ratios**2).mean(axis=0)).max() < 1.5, "sigmas that links, in RAM or not, are off"


def test_after_many_laps_a_false_loop_is_refused_and_a_true_one_is_not() -> None:
    slam, _ = many_laps()
    active, world = slam._active, GhostWorld(15)
    sure = max(slam.graph.links.values(), key=lambda link: link.information[0, 0]).information
    new = slam.graph.newest
    old = next(i for i in sorted(slam.memory.wm) if (new - i) % 15 == 0 and (i, new) not in slam.graph.links)
    true = between(world.T_world_base(new - 1), world.T_world_base(old - 1))
    for off_m in (0.1, 2.0):
        link = Link(new, old, LinkType.GLOBAL_CLOSURE, true @ make(np.eye(3), np.array([0.0, off_m, 0.0])), sure)
        closure = active.try_loops(active.graph, [link], slam.params)
        assert closure.refusal is not None
        assert closure.refusal.test == "RGBD/OptimizeMaxError"
    link = Link(new, old, LinkType.GLOBAL_CLOSURE, true, INFORMATION)
    assert active.try_loops(active.graph, [link], slam.params).accepted
