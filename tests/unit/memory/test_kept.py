"""Which frames are kept: not those of a fast robot, nor those that show too little, where that is asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.loop.closing import limited
from slam.memory.speed import Speed
from slam.params import Params
from slam.slam import Slam
from slam.types import Candidate, LinkType
from tests.nodes import INFORMATION, at
from tests.tours import EVERY, fed, sparse


@pytest.mark.parametrize(
    ("name", "limit", "fast"),
    [
        ("RGBD/LinearSpeedUpdate", 1.9, True),
        ("RGBD/LinearSpeedUpdate", 2.1, False),
        ("RGBD/LinearSpeedUpdate", 0.0, False),
        ("RGBD/AngularSpeedUpdate", 1.7, True),
        ("RGBD/AngularSpeedUpdate", 1.8, False),
    ],
)
def test_speed_is_motion_over_time(name: str, limit: float, fast: bool) -> None:
    params, speed = Params().changed({name: limit}), Speed()
    assert not speed.exceeds(0.0, at(0.0), params)
    assert speed.exceeds(0.5, at(1.0, 0.0, 50.0), params) == fast  # 2 m/s, 1.745 rad/s
    assert not speed.exceeds(1.0, None, params)
    assert not speed.exceeds(1.5, at(9.0), params), "a gap in tracking is no speed"


def test_a_fast_robot_makes_no_nodes() -> None:
    slow = Slam(EVERY.changed({"RGBD/LinearSpeedUpdate": 0.01}))
    fed(slow, sparse()[:4])
    assert len(slow.graph) == 1
    assert sum(frame.T_node_base is not None for frame in slow.frames) == 4, "the path has all frames"


@pytest.mark.parametrize("name", ["Mem/BadSignaturesIgnored", "Rtabmap/StartNewMapOnGoodSignature"])
def test_nodes_that_show_too_little_are_not_kept(name: str) -> None:
    dim = [replace(f, depth_m=np.where(np.arange(320) < 60, f.depth_m, 0).astype(np.float32)) for f in sparse()[:2]]
    frames = [*dim, *sparse()[2:5]]
    params = EVERY.changed({"Kp/BadSignRatio": 0.9, "Kp/MaxFeatures": 1000, "Vis/MaxFeatures": 1000})
    usual, picky = Slam(params), Slam(params.changed({name: True}))
    fed(usual, frames)
    fed(picky, frames)
    assert len(picky.graph) < len(usual.graph)
    words = {int(w) for bag in picky.memory.bags.values() for w in bag.words}
    assert set(picky.memory.dictionary.ids()) == words


def test_moving_rehearsal_hands_no_weight_on_when_told_so() -> None:
    params = EVERY.changed({"Mem/RehearsalSimilarity": 0.0})
    usual, still = Slam(params), Slam(params.changed({"Mem/RehearsalWeightIgnoredWhileMoving": True}))
    for slam in (usual, still):
        fed(slam, sparse()[:5])
    assert sum(usual.memory.weights.values()) == 4
    assert sum(still.memory.weights.values()) == 0


def test_loops_with_short_term_memory_are_local_in_time() -> None:
    slam = Slam(EVERY.changed({"RGBD/ProximityByTime": True}))
    updates = fed(slam, sparse()[:5])
    tried = [c for update in updates for c in update.candidates]
    assert {c.type for c in tried} == {LinkType.LOCAL_TIME_CLOSURE}
    assert {(c.from_id, c.to_id) for c in tried} == {(a, b) for a in range(1, 6) for b in range(1, a - 1)}
    accepted = [c for c in tried if c.refusal is None]
    assert accepted
    assert all((c.to_id, c.from_id) in slam.graph.links for c in accepted)


def test_a_loop_counts_for_no_surer_than_told() -> None:
    most = np.array([10.0, 1e9, 10.0, 1e9, 1e9, 1e9])
    found = Candidate(2, 1, LinkType.GLOBAL_CLOSURE, 0.5, 50, 40, at(0.0), INFORMATION, None)
    information = limited(found, most).information
    assert information is not None
    np.testing.assert_allclose(np.diagonal(information), [10.0, 1e4, 10.0, 1e5, 1e5, 1e5])
    assert np.linalg.eigvalsh(information).min() > 0


def test_loops_are_limited_by_the_surest_odometry() -> None:
    slam = Slam(EVERY.changed({"RGBD/LoopCovLimited": True, "RGBD/ProximityByTime": True}))
    fed(slam, sparse()[:6])
    surest = np.max([np.diagonal(k.information) for k in slam.graph.links.values() if not k.type.is_loop], axis=0)
    loops = [np.diagonal(link.information) for link in slam.graph.links.values() if link.type.is_loop]
    assert loops
    assert all((loop <= surest * (1 + 1e-9)).all() for loop in loops)
