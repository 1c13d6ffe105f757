"""The same frames, parameters and seed give the same map, bit for bit; and a map file changes nothing in it."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from slam.slam import Slam
from slam.types import Candidate, Update
from tests.tours import EVERY, fed, mapped, sparse


@pytest.fixture(scope="module", params=[0, 25], ids=["all in working memory", "25 nodes in working memory"])
def twice(request: pytest.FixtureRequest) -> tuple[Slam, list[Update], Slam, list[Update]]:
    """One run with a map file and one without."""
    stored = mapped(request.param)
    params = EVERY.changed({"Rtabmap/MemoryThr": request.param})
    slam = Slam(params, seed=3)
    updates = fed(slam, sparse())
    slam.close()
    return stored.slam, list(stored.updates), slam, updates


def same(a: Any, b: Any) -> bool:
    if a is None or b is None:
        return a is b
    return bool(np.array_equal(a, b, equal_nan=True))


def test_poses_and_path_are_the_same(twice: tuple[Slam, list[Update], Slam, list[Update]]) -> None:
    first, updates, second, again = twice
    for a, b in zip(updates, again, strict=True):
        assert same(a.T_map_base, b.T_map_base), f"frame {a.frame_index}"
        assert same(a.odometry.covariance, b.odometry.covariance)
    assert first.graph.poses.keys() == second.graph.poses.keys()
    assert all(same(T, second.graph.poses[i]) for i, T in first.graph.poses.items())
    assert all(same(a.T_node_base, b.T_node_base) for a, b in zip(first.frames, second.frames, strict=True))
    assert first.graph.links.keys() == second.graph.links.keys()
    for pair, link in first.graph.links.items():
        other = second.graph.links[pair]
        assert (link.from_id, link.type) == (other.from_id, other.type)
        assert same(link.T_from_to, other.T_from_to)
        assert same(link.information, other.information)


def test_candidates_and_beliefs_are_the_same(twice: tuple[Slam, list[Update], Slam, list[Update]]) -> None:
    _, updates, _, again = twice
    for a, b in zip(updates, again, strict=True):
        assert len(a.candidates) == len(b.candidates)
        for one, other in zip(a.candidates, b.candidates, strict=True):
            for field in fields(Candidate):
                mine, theirs = getattr(one, field.name), getattr(other, field.name)
                equal = mine == theirs if field.name in ("type", "refusal") else same(mine, theirs)
                assert equal, f"{field.name} of {one.from_id}-{one.to_id}"
        assert (a.posterior is None) == (b.posterior is None)
        if a.posterior is not None and b.posterior is not None:
            assert same(a.posterior.node_ids, b.posterior.node_ids)
            assert same(a.posterior.probability, b.posterior.probability)
            assert same(a.posterior.likelihood, b.posterior.likelihood)


def test_memories_are_the_same(twice: tuple[Slam, list[Update], Slam, list[Update]]) -> None:
    first, updates, second, again = twice
    assert [a.tiers for a in updates] == [b.tiers for b in again]
    assert first.memory.weights == second.memory.weights
    assert first.memory.dictionary.ids() == second.memory.dictionary.ids()
    for node_id, node in first.memory.nodes.items():
        assert same(node.word_ids, second.memory.nodes[node_id].word_ids)


def test_statistics_but_for_times_are_the_same(twice: tuple[Slam, list[Update], Slam, list[Update]]) -> None:
    _, updates, _, again = twice
    for a, b in zip(updates, again, strict=True):
        assert a.statistics.keys() == b.statistics.keys()
        for name, value in a.statistics.items():
            if not name.endswith("/ms"):
                assert value == b.statistics[name], name


def test_another_seed_still_closes_the_loop() -> None:
    slam = Slam(EVERY, seed=4)
    updates = fed(slam, sparse())
    assert any(c.refusal is None for update in updates for c in update.candidates)
