"""Global loops: when the belief is worth a look, and what the images say then."""

from __future__ import annotations

import numpy as np
import pytest

from slam.loop.appearance import AppearanceLoops, verify
from slam.params import Params
from slam.types import LinkType, Node, Posterior
from tests.scenes import CAMERA
from tests.unit.registration.test_visual import two_views

PARAMS = Params()


def belief(value: float, places: int = 5) -> Posterior:
    probability = np.full(places, value / places)
    return Posterior(np.arange(1, places + 1, dtype=np.int32), np.ones(places), probability, 1.0 - value, 1.0)


@pytest.mark.parametrize(
    ("value", "connected", "name"),
    [
        (0.111, True, None),
        (0.109, True, "Rtabmap/LoopThr"),
        (0.109, False, None),
        (0.051, False, None),
        (0.049, False, "RGBD/AggressiveLoopThr"),
    ],
)
def test_the_threshold_depends_on_whether_the_place_is_joined(value: float, connected: bool, name: str | None) -> None:
    refusal = AppearanceLoops().hypothesis(belief(value), connected=connected, params=PARAMS)
    assert (refusal.test if refusal else None) == name
    if refusal is not None:
        assert refusal.value == pytest.approx(value)
        assert refusal.threshold == PARAMS.get(refusal.test)
        assert f"{value:.3f}" in refusal.text
        assert refusal.test in refusal.text


@pytest.mark.parametrize(("value", "tried"), [(0.111, True), (0.109, False)])
def test_without_the_aggressive_threshold_the_usual_one_decides(value: float, tried: bool) -> None:
    params = PARAMS.changed({"RGBD/AggressiveLoopThr": 1.0})
    refusal = AppearanceLoops().hypothesis(belief(value), connected=False, params=params)
    assert (refusal is None) == tried
    assert refusal is None or refusal.test == "Rtabmap/LoopThr"


def test_a_single_place_is_no_choice() -> None:
    refusal = AppearanceLoops().hypothesis(belief(0.9, 1), connected=True, params=PARAMS)
    assert refusal is not None
    assert (refusal.test, refusal.value, refusal.threshold) == ("places", 1, 2)
    assert AppearanceLoops().hypothesis(belief(0.9, 2), connected=True, params=PARAMS) is None


def test_the_hypothesis_must_not_collapse() -> None:
    params = PARAMS.changed({"Rtabmap/LoopRatio": 0.5})
    loops = AppearanceLoops()
    assert loops.hypothesis(belief(0.8), connected=True, params=params) is None
    refusal = loops.hypothesis(belief(0.39), connected=True, params=params)
    assert refusal is not None
    assert refusal.test == "Rtabmap/LoopRatio"
    assert refusal.threshold == pytest.approx(0.4)
    assert loops.hypothesis(belief(0.2), connected=True, params=params) is None, "half of 0.39 is less"


def nodes(seed: int, other: int | None = None) -> tuple[Node, Node]:
    """Two nodes of one place, or the second of another."""
    new, old, _ = two_views(seed)
    if other is not None:
        _, old, _ = two_views(other)
    made = []
    for node_id, items in ((9, new), (2, old)):
        made.append(Node(node_id, 0, 0, float(node_id), np.eye(4), items, np.ones(len(items), np.int32), CAMERA))
    return made[0], made[1]


def test_an_accepted_candidate_has_all_its_evidence() -> None:
    found = verify(*nodes(1), LinkType.GLOBAL_CLOSURE, 0.7, PARAMS)
    assert (found.from_id, found.to_id, found.type, found.posterior) == (9, 2, LinkType.GLOBAL_CLOSURE, 0.7)
    assert found.refusal is None
    assert found.T_from_to is not None
    assert found.information is not None
    np.testing.assert_allclose(found.T_from_to, two_views(1)[2], atol=0.03)
    assert PARAMS.Vis.MinInliers <= found.inliers <= found.matches
    assert (np.linalg.eigvalsh(found.information) > 0).all()


def test_images_that_disagree_refuse() -> None:
    found = verify(*nodes(1, other=2), LinkType.LOCAL_SPACE_CLOSURE, float("nan"), PARAMS)
    assert found.refusal is not None
    assert found.refusal.test == "Vis/MinInliers"
    assert found.T_from_to is None
    assert found.information is None
    assert found.matches >= 0


def test_a_loop_longer_than_allowed_is_refused_with_its_length() -> None:
    length = float(np.linalg.norm(two_views(1)[2][:3, 3]))
    params = PARAMS.changed({"RGBD/MaxLoopClosureDistance": length / 2})
    found = verify(*nodes(1), LinkType.GLOBAL_CLOSURE, 0.7, params)
    assert found.refusal is not None
    assert found.refusal.test == "RGBD/MaxLoopClosureDistance"
    assert found.refusal.value == pytest.approx(length, abs=0.03)
    assert found.T_from_to is not None, "the evidence stays"
    params = PARAMS.changed({"RGBD/MaxLoopClosureDistance": length * 2})
    assert verify(*nodes(1), LinkType.GLOBAL_CLOSURE, 0.7, params).refusal is None
