"""``Reg/Strategy`` chooses; what each strategy needs, it says."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from slam.geometry import Pose, between, flattened, inverse, rotation_angle, se3_exp, transform, translation_norm
from slam.params import Params, Value
from slam.registration.choice import registrar
from slam.registration.icp import IcpRegistration
from slam.registration.view import View
from slam.registration.visual import VisualRegistration
from slam.types import Images
from tests.clouds import CORNER, scan
from tests.nodes import random_descriptors
from tests.scenes import CAMERA
from tests.unit.registration.test_visual import seen_from, two_views

PARAMS = Params()


def changed(**values: Value) -> Params:
    return PARAMS.changed({name.replace("_", "/"): value for name, value in values.items()})


def views(seed: int = 1) -> tuple[View, View, Pose]:
    """Two views with key points and clouds of one place, and ``T_from_to``."""
    new, old, T_from_to = two_views(seed)
    there = scan(CORNER, np.eye(4), 1), scan(CORNER, T_from_to, 2)
    return View(new, CAMERA, there[0]), View(old, CAMERA, there[1]), T_from_to


def error(T: Pose | None, truth: Pose) -> tuple[float, float]:
    assert T is not None
    return translation_norm(between(truth, T)), rotation_angle(between(truth, T))


def test_without_a_guess_icp_starts_from_the_images() -> None:
    a, b, T_from_to = views()
    assert translation_norm(T_from_to) > 0.2, "farther than ICP would go alone"
    visual = registrar(PARAMS).register(a, b, None, PARAMS)
    assert visual.icp is None
    assert type(registrar(PARAMS)) is VisualRegistration
    for strategy in (1, 2):
        params = changed(Reg_Strategy=strategy)
        found = registrar(params).register(a, b, None, params)
        assert found.icp is not None
        assert error(found.T_from_to, T_from_to)[0] < 0.005
        np.testing.assert_array_equal(found.matches, visual.matches)
        np.testing.assert_array_equal(found.inliers, visual.inliers)
        assert found.covariance[0, 0] != visual.covariance[0, 0]


def test_with_a_guess_only_strategy_2_asks_the_images() -> None:
    a, b, T_from_to = views()
    guess = np.asarray(T_from_to @ se3_exp(np.full(6, 0.02)))
    icp = registrar(changed(Reg_Strategy=1)).register(a, b, guess, changed(Reg_Strategy=1))
    assert len(icp.matches) == 0
    alone = IcpRegistration().register(a, b, guess, PARAMS)
    np.testing.assert_array_equal(icp.T_from_to, alone.T_from_to)
    both = registrar(changed(Reg_Strategy=2)).register(a, b, guess, changed(Reg_Strategy=2))
    assert len(both.matches) >= 20
    assert both.icp is not None


@pytest.mark.parametrize("strategy", [1, 2])
def test_what_one_of_both_refuses_is_refused(strategy: int) -> None:
    params = changed(Reg_Strategy=strategy)
    a, b, _ = views()
    _, other, _ = views(2)
    unseen = registrar(params).register(a, replace(b, features=other.features), None, params)
    assert unseen.refusal is not None
    assert unseen.refusal.test == "Vis/MinInliers"
    blind = registrar(params).register(a, replace(b, scan=None), None, params)
    assert blind.refusal is not None
    assert blind.refusal.test == "scan"
    assert len(blind.matches) >= 20


@pytest.mark.parametrize("estimation", [0, 1])
def test_a_guess_spares_the_search_among_all(estimation: int) -> None:
    a, b, T_from_to = views()
    params = changed(Vis_EstimationType=estimation)
    guess = np.asarray(T_from_to @ se3_exp(np.full(6, 0.01)))
    found = VisualRegistration().register(a, b, guess, params)
    assert error(found.T_from_to, T_from_to)[0] < 0.02
    assert error(found.T_from_to, T_from_to)[1] < 0.01
    astray = VisualRegistration().register(a, b, T_from_to @ se3_exp(np.full(6, 0.4)), params)
    assert len(astray.matches) < len(found.matches)


def test_three_dimensions_need_depth_on_both_sides() -> None:
    new, _, _ = two_views(1)
    _, flat, _ = two_views(1, depth=0.0)
    found = VisualRegistration().register(View(new, CAMERA), View(flat, CAMERA), None, changed(Vis_EstimationType=0))
    assert found.refusal is not None
    assert found.refusal.text == "0 inliers, fewer than Vis/MinInliers 20"


def test_the_second_look_may_be_left_out() -> None:
    # Each look is there twice, so that only where a point should be tells which is which; forty looks are unique.
    points = np.random.default_rng(3).uniform((2, -2, -1.5), (5, 2, 1.5), (200, 3))
    looks = random_descriptors(200, 3)
    looks[120:] = looks[40:120]
    T_from_to = se3_exp(np.array([0.1, -0.1, 0.05, 0.02, 0.05, -0.04]))
    a, b = (View(seen_from(T, points, looks, 7 + k), CAMERA) for k, T in enumerate((np.eye(4), T_from_to)))
    once = VisualRegistration().register(a, b, None, changed(Reg_RepeatOnce=False, Vis_MinInliers=10))
    twice = VisualRegistration().register(a, b, None, changed(Vis_MinInliers=10))
    assert twice.inliers.sum() > 2 * once.inliers.sum() >= 20


@pytest.mark.parametrize("strategy", [0, 2])
def test_planar_results_are_planar(strategy: int) -> None:
    a, b, T_from_to = views()
    params = changed(Reg_Strategy=strategy, Reg_Force3DoF=True, Icp_MaxTranslation=0.0, Icp_CorrespondenceRatio=0.0)
    found = registrar(params).register(a, b, None, params)
    assert found.T_from_to is not None
    np.testing.assert_allclose(flattened(found.T_from_to), found.T_from_to, atol=1e-15)
    if strategy == 0:
        assert translation_norm(between(flattened(T_from_to), found.T_from_to)) < 0.02


@pytest.mark.parametrize(
    ("name", "loose", "tight"),
    [("MeanInliersDistance", 5.5, 2.0), ("MinInliersDistribution", 0.01, 0.4), ("PnPMaxVariance", 0.1, 1e-7)],
)
def test_optional_tests_refuse_with_their_number(name: str, loose: float, tight: float) -> None:
    a, b, _ = views()
    assert VisualRegistration().register(a, b, None, changed(**{f"Vis_{name}": loose})).refusal is None
    found = VisualRegistration().register(a, b, None, changed(**{f"Vis_{name}": tight}))
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.test == f"Vis/{name}"
    assert (found.refusal.value > tight) == (name != "MinInliersDistribution")
    assert f"Vis/{name} {tight:g}" in found.refusal.text


def test_the_linear_covariance_may_tell_axes_apart() -> None:
    a, b, _ = views()
    together = VisualRegistration().register(a, b, None, PARAMS).covariance.diagonal()
    apart = VisualRegistration().register(a, b, None, changed(Vis_PnPSplitLinearCovComponents=True))
    linear = apart.covariance.diagonal()[:3]
    assert (together[:3] == together[0]).all()
    assert len(set(linear.tolist())) == 3
    assert (linear < together[0]).all()


@pytest.mark.parametrize("flags", [0, 1, 2])
def test_every_solver_finds_the_pose(flags: int) -> None:
    a, b, T_from_to = views()
    found = VisualRegistration().register(a, b, None, changed(Vis_PnPFlags=flags))
    assert error(found.T_from_to, T_from_to)[0] < 0.02


def pictured(depth: float = 2.0) -> tuple[View, View, Pose]:
    """A wall with a pattern, seen from two places, and ``T_from_to``: the second 5 cm to the right of the first."""
    rng = np.random.default_rng(0)
    pattern = cv2.GaussianBlur(rng.integers(0, 256, (480, 700)).astype(np.uint8), (0, 0), 3)
    pattern = np.asarray(cv2.normalize(pattern, None, 0, 255, cv2.NORM_MINMAX), np.uint8)
    shift = 21
    metres = shift * depth / CAMERA.fx
    z = np.full((480, 640), depth, np.float32)
    looks = [Images(np.ascontiguousarray(pattern[:, x : x + 640]), z) for x in (0, shift)]
    u, v = np.meshgrid(np.arange(60, 600, 30), np.arange(40, 440, 30))
    pixels = np.column_stack([u.ravel(), v.ravel()]).astype(np.float32)
    points = transform(CAMERA.T_base_cam, CAMERA.unproject(pixels, np.full(len(pixels), depth))).astype(np.float32)
    items = two_views(1, 400)[0].take(np.zeros(len(pixels), np.int64))
    items = replace(items, pixels=pixels, points_base=points)
    T_from_to = np.eye(4)
    T_from_to[1, 3] = -metres
    return View(items, CAMERA, None, looks[0]), View(items, CAMERA, None, looks[1]), T_from_to


@pytest.mark.parametrize("guessed", [False, True])
def test_optical_flow_follows_points_through_the_images(guessed: bool) -> None:
    a, b, T_from_to = pictured()
    params = changed(Vis_CorType=1)
    found = VisualRegistration().register(a, b, T_from_to if guessed else None, params)
    assert error(found.T_from_to, T_from_to)[0] < 0.005
    assert error(found.T_from_to, T_from_to)[1] < 0.003
    assert found.inliers.sum() > 0.9 * len(a.features) * 0.9
    assert found.covariance[0, 0] < 1e-3, "the second image has depth"


def test_optical_flow_without_images_says_so() -> None:
    a, b, _ = pictured()
    for missing in ((replace(a, images=None), b), (a, replace(b, images=None))):
        found = VisualRegistration().register(*missing, None, changed(Vis_CorType=1))
        assert found.refusal is not None
        assert found.refusal.test == "Vis/CorType"


def test_optical_flow_leaves_out_what_looks_different() -> None:
    a, b, _ = pictured()
    assert b.images is not None
    dark = b.images.gray.copy()
    dark[:, 320:] = 0
    found = VisualRegistration().register(
        a, replace(b, images=replace(b.images, gray=dark)), None, changed(Vis_CorType=1)
    )
    assert found.T_from_to is not None
    assert a.features.pixels[found.matches[found.inliers, 0], 0].max() < 400


def test_optical_flow_trusts_only_what_looks_the_same() -> None:
    a, b, _ = pictured()
    assert b.images is not None
    brighter = replace(b, images=replace(b.images, gray=np.minimum(b.images.gray, 200) + np.uint8(30)))
    every = VisualRegistration().register(a, brighter, None, changed(Vis_CorType=1, Vis_CorFlowErrorThreshold=255.0))
    strict = VisualRegistration().register(a, brighter, None, changed(Vis_CorType=1, Vis_CorFlowErrorThreshold=5.0))
    assert len(every.matches) > 20 > len(strict.matches)


def test_flow_can_be_used_after_inverting() -> None:
    a, b, T_from_to = pictured()
    back = VisualRegistration().register(b, a, None, changed(Vis_CorType=1))
    assert error(back.T_from_to, inverse(T_from_to))[0] < 0.005
