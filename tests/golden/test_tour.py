"""A lap of the rendered tour and the start of the next: how good the map must be, and which loops close it."""

from __future__ import annotations

import numpy as np
import pytest

from slam.geometry import between, rotation_angle, translation_norm
from slam.run import ate_rmse_m
from slam.slam import Slam
from slam.types import LinkType
from tests.tours import EVERY, LAP, Mapped, fed, mapped, sparse, truth


@pytest.fixture(scope="module", params=[0, 25], ids=["all in working memory", "25 nodes in working memory"])
def tour(request: pytest.FixtureRequest) -> Mapped:
    return mapped(request.param)


def test_every_frame_becomes_a_node_and_none_is_lost(tour: Mapped) -> None:
    assert len(tour.slam.graph) == len(tour.updates) == len(sparse())
    assert all(update.T_map_base is not None for update in tour.updates)
    neighbors = [link for link in tour.slam.graph.links.values() if link.type is LinkType.NEIGHBOR]
    assert len(neighbors) == len(sparse()) - 1
    assert set(tour.slam.graph.map_ids.values()) == {0}


def test_the_path_is_accurate(tour: Mapped) -> None:
    error = ate_rmse_m(tour.slam)
    assert error is not None
    assert error < 0.06


def test_the_second_lap_is_recognised(tour: Mapped) -> None:
    accepted = [c for c in tour.candidates if c.refusal is None]
    closures = [c for c in accepted if c.type is LinkType.GLOBAL_CLOSURE]
    assert len(closures) >= 8
    assert {c.from_id for c in closures} <= set(range(LAP - 2, len(sparse()) + 1))
    assert all(c.to_id < 30 and c.posterior >= 0.11 for c in closures)
    links = [link for link in tour.slam.graph.links.values() if link.type.is_loop]
    assert sorted(link.pair for link in links) == sorted((c.to_id, c.from_id) for c in accepted)


def test_all_accepted_loops_are_true(tour: Mapped) -> None:
    T_world_base = truth(sparse())
    for candidate in tour.candidates:
        if candidate.refusal is None:
            assert candidate.T_from_to is not None
            true = between(T_world_base[candidate.from_id - 1], T_world_base[candidate.to_id - 1])
            error = between(true, candidate.T_from_to)
            assert translation_norm(error) < 0.1, f"{candidate.from_id}-{candidate.to_id}"
            assert rotation_angle(error) < np.radians(2)
            assert candidate.inliers >= 20


def test_refused_ones_say_why() -> None:
    # With LoopThr 0 the filter's best guess is always put to the images, and on the first lap it is always wrong.
    updates = fed(Slam(EVERY.changed({"Rtabmap/LoopThr": 0.0})), sparse()[:30])
    candidates = [candidate for update in updates for candidate in update.candidates]
    assert len(candidates) >= 15
    for candidate in candidates:
        assert candidate.refusal is not None
        assert candidate.refusal.test == "Vis/MinInliers"
        assert candidate.refusal.value < candidate.refusal.threshold == 20
        assert str(int(candidate.refusal.value)) in candidate.refusal.text
        assert candidate.T_from_to is None


def test_loops_bring_the_map_nearer_to_the_truth(tour: Mapped) -> None:
    first = next(k for k, update in enumerate(tour.updates) if update.optimized)
    T_world = truth(sparse())
    # The drift of the lap, as the first pose sees its last: odometry alone, and the map at the end.
    odom, poses = tour.slam.graph.T_odom, tour.slam.graph.poses
    true = between(T_world[0], T_world[first])
    drift = translation_norm(between(true, between(odom[1], odom[first + 1])))
    left = translation_norm(between(true, between(poses[1], poses[first + 1])))
    assert left < 0.5 * drift
    assert left < 0.06
