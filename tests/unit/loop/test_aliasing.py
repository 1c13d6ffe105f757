"""A place elsewhere in the map that looks like the one a loop leads to is named, and how like it is."""

from __future__ import annotations

import numpy as np
import pytest

from slam.geometry import Pose, se3_exp
from slam.loop.aliasing import NEARLY, look_alike
from slam.types import Posterior


def poses() -> dict[int, Pose]:
    """Nodes 1 to 30 a metre apart; node 31 at node 1, looking back."""
    found = {i: se3_exp(np.array([float(i), 0, 0, 0, 0, 0])) for i in range(1, 31)}
    found[31] = found[1] @ se3_exp(np.array([0, 0, 0, 0, 0, np.pi / 2]))
    return found


def belief(probability: dict[int, float], likelihood: dict[int, float] | None = None) -> Posterior:
    ids = np.array(sorted(probability), np.int32)
    known = likelihood or {}
    return Posterior(
        ids, np.array([known.get(int(i), 1.0) for i in ids]), np.array([probability[int(i)] for i in ids]), 0.1, 1.0
    )


def test_a_far_place_that_is_nearly_as_likely_is_a_rival_and_neighbours_are_none() -> None:
    found = look_alike(belief({9: 0.4, 10: 0.5, 11: 0.45, 25: 0.42}), 10, poses())
    assert found is not None
    assert (found.node_id, found.share) == (25, pytest.approx(0.84))
    assert found.distance_m == pytest.approx(15.0)
    assert found.share >= NEARLY


def test_the_likelihood_counts_above_chance() -> None:
    found = look_alike(belief({10: 0.8, 25: 0.01, 28: 0.02}, {10: 5.0, 25: 4.6, 28: 1.0}), 10, poses())
    assert found is not None
    assert (found.node_id, found.share) == (25, pytest.approx(0.9))


def test_the_same_spot_looked_at_another_way_is_elsewhere() -> None:
    found = look_alike(belief({1: 0.5, 2: 0.4, 31: 0.3}), 1, poses())
    assert found is not None
    assert found.node_id == 31


@pytest.mark.parametrize("place", [12, 40])
def test_a_place_that_the_belief_or_the_map_lacks_has_no_rival(place: int) -> None:
    assert look_alike(belief({10: 0.5, 40: 0.5}), place, poses()) is None


def test_alone_in_the_map_there_is_no_rival() -> None:
    assert look_alike(belief({9: 0.4, 10: 0.5}), 10, poses()) is None
