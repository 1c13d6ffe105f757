"""A loop with the old node's neighbours: more points, a pose at least as good, refusals as ever."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from slam.geometry import Pose, between, flattened, inverse, rotation_angle, translation_norm
from slam.loop import local_bundle
from slam.loop.appearance import verify
from slam.loop.local_bundle import Beside, nodes_beside, register_bundled
from slam.params import Params
from slam.registration.view import View
from slam.registration.visual import VisualRegistration
from slam.types import LinkType, Node
from tests.nodes import chain, join, random_descriptors
from tests.scenes import CAMERA, random_pose
from tests.unit.registration.test_visual import seen_from

PARAMS = Params()
BUNDLED = PARAMS.changed({"RGBD/LocalBundleOnLoopClosure": True})


def place(
    seed: int, *, count: int = 200, far: float = 0.3, rough: float = 0.01
) -> tuple[View, View, list[Beside], Pose]:
    """A new view, an old one, two beside that one, and the true ``T_new_old``; depth is off by ``rough`` of it."""
    rng = np.random.default_rng(seed)
    points = rng.uniform((2, -2, -1.5), (5, 2, 1.5), (count, 3))
    looks = random_descriptors(count, seed)
    poses = [random_pose(rng, far, 0.1) for _ in range(4)]
    views = []
    for k, T in enumerate(poses):
        items = seen_from(T, points, looks, 10 * seed + k)
        noise = 1 + rng.normal(size=(len(items), 1)) * rough
        views.append(View(replace(items, points_base=(items.points_base * noise).astype(np.float32)), CAMERA))
    T_old = poses[1]
    beside = [Beside(view, between(T_old, T)) for view, T in zip(views[2:], poses[2:], strict=True)]
    return views[0], views[1], beside, between(poses[0], T_old)


def test_the_pose_is_better_than_from_two_views_that_share_little() -> None:
    alone, together = [], []
    for seed in range(12):
        new, old, beside, T_new_old = place(seed)
        old = replace(old, features=old.features.take(np.arange(60)))
        single = VisualRegistration().register(new, old, None, PARAMS).T_from_to
        found = register_bundled(new, old, beside, PARAMS).T_from_to
        assert single is not None
        assert found is not None
        alone.append(translation_norm(between(T_new_old, single)))
        together.append(translation_norm(between(T_new_old, found)))
        assert rotation_angle(between(T_new_old, found)) < 0.005
    assert np.mean(together) < 0.8 * np.mean(alone)


def test_adjusting_moves_the_pose_nearer_to_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    places = [place(seed, rough=0.04) for seed in range(12)]
    adjusted = [register_bundled(new, old, beside, PARAMS).T_from_to for new, old, beside, _ in places]
    monkeypatch.setattr(local_bundle, "_adjusted", lambda _, __, T_old_new, ___, inliers: (T_old_new, inliers))
    located = [register_bundled(new, old, beside, PARAMS).T_from_to for new, old, beside, _ in places]
    errors = np.array(
        [
            [translation_norm(between(truth, T)) for T in pair if T is not None]
            for pair, (_, _, _, truth) in zip(zip(adjusted, located, strict=True), places, strict=True)
        ]
    )
    assert errors[:, 0].mean() < 0.9 * errors[:, 1].mean()


def test_what_only_a_neighbour_saw_counts_too() -> None:
    new, old, beside, T_new_old = place(1)
    few = replace(old, features=old.features.take(np.arange(12)))
    assert VisualRegistration().register(new, few, None, PARAMS).refusal is not None
    found = register_bundled(new, few, beside, PARAMS)
    assert found.T_from_to is not None
    assert translation_norm(between(T_new_old, found.T_from_to)) < 0.03
    assert (found.matches[:, 1] == -1).sum() > 20
    rows_new, rows_old = found.matches[found.matches[:, 1] >= 0].T
    differing = np.unpackbits(new.features.descriptors[rows_new] ^ few.features.descriptors[rows_old], axis=1).sum(
        axis=1
    )
    assert differing.max() <= 16


@pytest.mark.parametrize("nothing", [True, False])
def test_another_place_is_refused(nothing: bool) -> None:
    new, old, beside, _ = place(1)
    other, _, _, _ = place(2)
    other = replace(other, features=other.features.take(np.zeros(0, np.int64))) if nothing else other
    found = register_bundled(other, old, beside, PARAMS)
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.test == "Vis/MinInliers"
    assert found.refusal.value < found.refusal.threshold == 20
    assert new is not other


def test_different_cameras_are_located_but_not_adjusted() -> None:
    new, old, beside, T_new_old = place(3)
    zoomed = replace(CAMERA, fx=600.0)
    found = register_bundled(new, old, [replace(beside[0], view=replace(beside[0].view, camera=zoomed))], PARAMS)
    assert found.T_from_to is not None
    assert translation_norm(between(T_new_old, found.T_from_to)) < 0.05


def test_planar_and_optional_tests_hold_here_too() -> None:
    new, old, beside, _ = place(4)
    flat = register_bundled(new, old, beside, PARAMS.changed({"Reg/Force3DoF": True})).T_from_to
    assert flat is not None
    np.testing.assert_allclose(flattened(flat), flat, atol=1e-15)
    refused = register_bundled(new, old, beside, PARAMS.changed({"Vis/PnPMaxVariance": 1e-9}))
    assert refused.refusal is not None
    assert refused.refusal.test == "Vis/PnPMaxVariance"
    assert refused.T_from_to is None


def nodes(seed: int) -> dict[int, Node]:
    new, old, beside, _ = place(seed)
    views = {9: new, 3: old, 2: beside[0].view, 4: beside[1].view}
    return {
        i: Node(i, 0, 0, float(i), np.eye(4), v.features, np.ones(len(v.features), np.int32), CAMERA)
        for i, v in views.items()
    }


def test_neighbours_in_ram_are_beside_and_only_when_asked_for() -> None:
    graph, known = chain(9), nodes(1)
    join(graph, 9, 3, LinkType.LOCAL_SPACE_CLOSURE)
    assert nodes_beside(3, known, graph, PARAMS) == ()
    beside = nodes_beside(3, known, graph, BUNDLED)
    assert [item.view.features for item in beside] == [known[2].features, known[4].features]
    np.testing.assert_allclose(beside[0].T_old_beside, inverse(graph.poses[3]) @ graph.poses[2])
    del known[4]
    assert len(nodes_beside(3, known, graph, BUNDLED)) == 1


def test_a_candidate_is_made_of_it() -> None:
    known = nodes(5)
    _, _, beside, T_new_old = place(5)
    found = verify(known[9], known[3], LinkType.GLOBAL_CLOSURE, 0.5, BUNDLED, beside=beside)
    plain = verify(known[9], known[3], LinkType.GLOBAL_CLOSURE, 0.5, BUNDLED)
    assert found.T_from_to is not None
    assert found.inliers > plain.inliers
    assert translation_norm(between(T_new_old, found.T_from_to)) < 0.03
    blind = verify(
        known[9], known[3], LinkType.GLOBAL_CLOSURE, 0.5, BUNDLED.changed({"Reg/Strategy": 2}), beside=beside
    )
    assert blind.refusal is not None
    assert blind.refusal.test == "scan"
