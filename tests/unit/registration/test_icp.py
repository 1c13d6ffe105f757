"""ICP: what surfaces fix is found, what they don't is left to the guess, and a refusal names its limit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from slam.geometry import Pose, between, flattened, inverse, make, rotation_angle, se3_exp, so3_exp, translation_norm
from slam.params import Params, Value
from slam.registration.cells import thinned
from slam.registration.complexity import complexity
from slam.registration.icp import IcpRegistration
from slam.types import Registration, Scan
from tests.clouds import CORNER, CORRIDOR, WALL, scan, view

PARAMS = Params()
seeds = st.integers(0, 1000)
quickly = settings(max_examples=10)


def changed(**values: Value) -> Params:
    return PARAMS.changed({f"Icp/{name}": value for name, value in values.items()})


def registered(a: Scan, b: Scan, guess: Pose | None, params: Params = PARAMS) -> Registration:
    return IcpRegistration().register(view(a), view(b), guess, params)


def offset(seed: int, metres: float = 0.05, radians: float = 0.03) -> Pose:
    rng = np.random.default_rng(seed)
    return se3_exp(np.concatenate([rng.uniform(-metres, metres, 3), rng.uniform(-radians, radians, 3)]))


@quickly
@given(seeds, st.booleans())
def test_the_motion_in_a_corner_is_found(seed: int, to_plane: bool) -> None:
    T_from_to = offset(seed)
    a, b = scan(CORNER, np.eye(4), seed), scan(CORNER, T_from_to, seed + 1)
    found = registered(a, b, None, changed(PointToPlane=to_plane))
    assert found.T_from_to is not None
    error = between(T_from_to, found.T_from_to)
    assert translation_norm(error) < (0.004 if to_plane else 0.015)
    assert rotation_angle(error) < (0.002 if to_plane else 0.008)
    assert found.icp is not None
    assert found.icp.ratio > 0.8
    assert found.icp.translation_m == pytest.approx(translation_norm(found.T_from_to))
    assert len(found.matches) == 0


@quickly
@given(seeds)
def test_on_a_wall_only_what_it_fixes_moves(seed: int) -> None:
    T_from_to = offset(seed)
    a, b = scan(WALL, np.eye(4), seed, 0.0005), scan(WALL, T_from_to, seed + 1, 0.0005)
    found = registered(a, b, np.eye(4))
    assert found.T_from_to is not None
    assert found.icp is not None
    assert found.icp.complexity < 0.02
    assert found.T_from_to[0, 3] == pytest.approx(T_from_to[0, 3] + T_from_to[0, :3] @ [3, 0, 0] - 3, abs=0.02)
    middle = found.T_from_to[:3, :3] @ np.array([3.0, 0.0, 0.0]) + found.T_from_to[:3, 3]
    assert abs(middle[1:]).max() < 0.005, "along the wall nothing is known"
    roll = np.arctan2(found.T_from_to[2, 1], found.T_from_to[2, 2])
    assert abs(roll) < 0.003


def test_in_a_corridor_the_way_along_is_left_to_the_guess() -> None:
    T_from_to = make(so3_exp(np.array([0.02, 0.01, -0.02])), np.array([0.08, 0.04, -0.03]))
    a, b = scan(CORRIDOR, np.eye(4), 1, 0.0), scan(CORRIDOR, T_from_to, 2, 0.0)
    found = registered(a, b, np.eye(4))
    assert found.T_from_to is not None
    along, aside, up = found.T_from_to[:3, 3]
    assert abs(along) < 0.05
    assert aside == pytest.approx(0.04, abs=0.03)
    assert up == pytest.approx(-0.03, abs=0.03)
    assert rotation_angle(between(T_from_to, found.T_from_to)) < 0.01


def test_the_plainer_scan_s_surfaces_count_in_the_first_frame() -> None:
    # The second scan looks half a turn to the side, so that its wall faces another of its own axes.
    guess = make(so3_exp(np.array([0.0, 0.0, 1.5])), np.zeros(3))
    T_from_to = np.asarray(make(np.eye(3), np.array([0.04, 0.05, -0.05])) @ guess)
    found = registered(scan(CORNER, np.eye(4), 1, 0.0), scan(WALL, T_from_to, 2, 0.0), guess)
    assert found.T_from_to is not None
    middle = found.T_from_to @ inverse(guess) @ np.array([3.0, 0.0, 0.0, 1.0])
    assert abs(middle[1:3]).max() < 0.01
    assert middle[0] - 3.0 == pytest.approx(0.04, abs=0.02)


def test_low_complexity_is_refused_or_trusted_where_that_is_asked_for() -> None:
    a, b = scan(WALL, np.eye(4), 1, 0.0005), scan(WALL, offset(3), 2, 0.0005)
    refused = registered(a, b, None, changed(PointToPlaneLowComplexityStrategy=0))
    assert refused.refusal is not None
    assert refused.refusal.test == "Icp/PointToPlaneMinComplexity"
    assert refused.refusal.value < refused.refusal.threshold == 0.02
    trusted = registered(a, b, None, changed(PointToPlaneLowComplexityStrategy=2))
    assert trusted.T_from_to is not None
    limited = registered(a, b, None)
    assert limited.T_from_to is not None
    assert abs(trusted.T_from_to[1:3, 3]).max() > abs(limited.T_from_to[1:3, 3]).max()


@pytest.mark.parametrize(
    ("name", "value"),
    [("MaxTranslation", 0.02), ("MaxRotation", 0.01), ("CorrespondenceRatio", 0.97)],
)
def test_a_refusal_names_its_limit(name: str, value: float) -> None:
    T_from_to = make(so3_exp(np.array([0.0, 0.0, 0.03])), np.array([0.03, 0.0, 0.0]))
    a, b = scan(CORNER, np.eye(4), 1), scan(CORNER, T_from_to, 2)
    assert registered(a, b, None).refusal is None
    found = registered(a, b, None, changed(**{name: value}))
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.test == f"Icp/{name}"
    assert found.refusal.threshold == value
    assert (found.refusal.value > value) == (name != "CorrespondenceRatio")
    assert f"Icp/{name} {value:g}" in found.refusal.text
    if name != "CorrespondenceRatio":
        assert registered(a, b, None, changed(**{name: 0.0})).refusal is None, "0 is no limit"


def test_scans_of_different_places_are_refused_by_their_partners() -> None:
    far = make(np.eye(3), np.array([9.0, 0.0, 0.0]))
    found = registered(scan(CORNER, np.eye(4), 1), scan(CORNER, far, 2), None)
    assert found.refusal is not None
    assert found.refusal.test == "Icp/CorrespondenceRatio"
    assert found.refusal.value <= 0.1


@pytest.mark.parametrize("which", ["first", "second", "few"])
def test_without_a_cloud_there_is_a_reason(which: str) -> None:
    a: Scan | None = scan(CORNER, np.eye(4), 1)
    b: Scan | None = a
    if which == "first":
        a = None
    else:
        b = None if which == "second" else Scan(np.ones((5, 3), np.float32))
    found = IcpRegistration().register(view(a), view(b), None, PARAMS)
    assert found.refusal is not None
    assert found.refusal.test == "scan"
    assert which in found.refusal.text or found.refusal.value < found.refusal.threshold


@pytest.mark.parametrize("name", ["Reg/Force3DoF", "Icp/Force4DoF"])
def test_fewer_degrees_of_freedom_stay_where_they_are(name: str) -> None:
    T_from_to = make(so3_exp(np.array([0.0, 0.0, 0.03])), np.array([0.03, -0.02, 0.0]))
    a, b = scan(CORNER, np.eye(4), 1, 0.01), scan(CORNER, T_from_to, 2, 0.01)
    found = registered(a, b, None, PARAMS.changed({name: True}))
    assert found.T_from_to is not None
    np.testing.assert_allclose(found.T_from_to[2, :3], [0, 0, 1], atol=1e-12)
    assert (found.T_from_to[2, 3] == 0) == (name == "Reg/Force3DoF")
    assert translation_norm(between(T_from_to, found.T_from_to)) < 0.01
    variances = found.covariance.diagonal()
    assert (variances[5] > variances[3]) == (name == "Icp/Force4DoF")
    if name == "Reg/Force3DoF":
        np.testing.assert_allclose(flattened(found.T_from_to), found.T_from_to, atol=1e-15)


def test_a_tenth_of_something_else_does_not_pull() -> None:
    T_from_to = offset(5)
    a, b = scan(CORNER, np.eye(4), 1), scan(CORNER, T_from_to, 2)
    points = b.points_base.copy()
    near = np.flatnonzero(points[:, 0] > 2.9)[:250]
    points[near] -= np.float32([0.08, 0.0, 0.0])
    trimmed = registered(a, Scan(points), T_from_to)
    plain = registered(a, Scan(points), T_from_to, changed(OutlierRatio=1.0))
    assert trimmed.T_from_to is not None
    assert plain.T_from_to is not None
    errors = [translation_norm(between(T_from_to, T)) for T in (trimmed.T_from_to, plain.T_from_to)]
    assert errors[0] < 0.5 * errors[1]


def test_range_steps_and_cubes_choose_the_points() -> None:
    cloud = scan(CORNER, np.eye(4), 1)
    whole = registered(cloud, cloud, None, changed(VoxelSize=0.0)).icp
    assert whole is not None
    assert whole.points == len(cloud)
    every_third = registered(cloud, cloud, None, changed(VoxelSize=0.0, DownsamplingStep=3)).icp
    assert every_third is not None
    assert every_third.points == len(cloud) // 3
    coarse = registered(cloud, cloud, None, changed(VoxelSize=0.2)).icp
    assert coarse is not None
    assert coarse.points < len(cloud) / 3
    distance = np.linalg.norm(cloud.points_base, axis=1)
    between_both = registered(cloud, cloud, None, changed(VoxelSize=0.0, RangeMin=1.5, RangeMax=3.0)).icp
    assert between_both is not None
    assert between_both.points == pytest.approx(((distance >= 1.5) & (distance <= 3.0)).sum(), abs=3)


def test_normals_of_the_scan_are_used_while_its_points_stay() -> None:
    T_from_to = offset(2)
    clouds = [
        Scan(thinned(scan(CORNER, T, k).points_base.astype(np.float64), 0.05).astype(np.float32))
        for k, T in enumerate((np.eye(4), T_from_to))
    ]
    wrong = [Scan(cloud.points_base, np.tile(np.float32([-1, 0, 0]), (len(cloud), 1))) for cloud in clouds]
    plain, misled = registered(*clouds, None), registered(wrong[0], wrong[1], None)
    assert plain.icp is not None
    assert misled.icp is not None
    assert plain.icp.complexity > 0.5
    assert misled.icp.complexity < 0.01
    coarser = registered(wrong[0], wrong[1], None, changed(VoxelSize=0.1)).icp
    assert coarser is not None
    assert coarser.complexity > 0.5, "made anew from what is left"


def test_covariance_is_a_tenth_of_the_residual_variance_and_turns_a_tenth_of_that() -> None:
    a, b = scan(CORNER, np.eye(4), 1), scan(CORNER, np.eye(4), 2)
    found = registered(a, b, None).covariance.diagonal()
    assert (found[:3] == found[0]).all()
    np.testing.assert_allclose(found[3:], found[0] / 10)
    assert 0.003**2 < 10 * found[0] < 0.1**2
    same = registered(a, a, None).covariance.diagonal()
    np.testing.assert_allclose(same, [1e-8] * 3 + [3e-8] * 3)


def test_the_same_scans_give_the_same_transform_bit_for_bit() -> None:
    a, b = scan(CORNER, np.eye(4), 1), scan(CORNER, offset(1), 2)
    first, second = registered(a, b, None), registered(a, b, None)
    assert first.T_from_to is not None
    np.testing.assert_array_equal(first.T_from_to, second.T_from_to)


def test_complexity_is_the_share_of_the_least_direction() -> None:
    x, y, z = np.eye(3)
    assert complexity(np.array([x, x, -x])).value == pytest.approx(0)
    assert complexity(np.array([x, -x, y])).value == pytest.approx(0)
    assert complexity(np.array([x, y, z])).value == pytest.approx(1)
    found = complexity(np.array([x, x, x, y, y, z]))
    np.testing.assert_allclose(found.shares, [1.5, 1.0, 0.5])
    np.testing.assert_allclose(np.abs(found.directions), np.eye(3), atol=1e-12)
    assert complexity(np.zeros((0, 3))).value == 0
