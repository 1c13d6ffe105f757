"""Registration of two nodes: the transform with its evidence, or why there is none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from slam.features.match import MAX_DISTANCE
from slam.geometry import Pose, between, inverse, rotation_angle, transform, translation_norm
from slam.params import Params
from slam.registration.visual import register
from slam.types import UNKNOWN_VARIANCE, Features
from tests.nodes import flipped, random_descriptors
from tests.scenes import CAMERA, random_pose

PARAMS = Params()
seeds = st.integers(0, 10_000)


def seen_from(
    T_world_base: Pose, points: NDArray[np.float64], descriptors: NDArray[np.uint8], seed: int, *, depth: float = 0.8
) -> Features:
    """What a view sees of points in the world, with half a pixel of noise; in random order."""
    rng = np.random.default_rng(seed)
    pixels = CAMERA.project(transform(inverse(T_world_base @ CAMERA.T_base_cam), points))
    pixels = pixels + rng.normal(size=pixels.shape) * 0.5
    inside = np.flatnonzero(((pixels > 5) & (pixels < [635, 475])).all(axis=1))
    inside = rng.permutation(inside)
    points_base = transform(inverse(T_world_base), points[inside]).astype(np.float32)
    points_base[rng.random(len(inside)) >= depth] = np.nan
    looks = [flipped(d, rng.choice(256, 8, replace=False).tolist()) for d in descriptors[inside]]
    count = len(inside)
    return Features(
        pixels=pixels[inside].astype(np.float32),
        sizes=np.full(count, 31, np.float32),
        angles=np.full(count, -1, np.float32),
        responses=np.ones(count, np.float32),
        octaves=np.zeros(count, np.int32),
        descriptors=np.array(looks, np.uint8).reshape(-1, 32),
        points_base=points_base,
    )


def two_views(seed: int, count: int = 200, **options: float) -> tuple[Features, Features, Pose]:
    """Two views of one place, and the true ``T_from_to``."""
    rng = np.random.default_rng(seed)
    points = rng.uniform((2, -2, -1.5), (5, 2, 1.5), (count, 3))
    looks = random_descriptors(count, seed)
    poses = [random_pose(rng, 0.3, 0.15) for _ in range(2)]
    views = [seen_from(T, points, looks, seed + k, **options) for k, T in enumerate(poses)]
    return views[0], views[1], between(*poses)


@settings(max_examples=15, deadline=None)
@given(seeds)
def test_two_views_of_a_place_are_joined(seed: int) -> None:
    new, old, T_from_to = two_views(seed)
    found = register(new, old, CAMERA, PARAMS)
    assert found.T_from_to is not None
    assert found.refusal is None
    error = between(T_from_to, found.T_from_to)
    assert translation_norm(error) < 0.02
    assert rotation_angle(error) < 0.01
    assert found.inliers.sum() >= 0.8 * len(found.matches)
    assert len(found.inliers) == len(found.matches)
    assert (np.linalg.eigvalsh(found.covariance) > 0).all()


def test_matches_name_the_rows_of_both_sets() -> None:
    new, old, _ = two_views(1)
    found = register(new, old, CAMERA, PARAMS)
    rows_from, rows_to = found.matches[found.inliers].T
    differing = np.unpackbits(new.descriptors[rows_from] ^ old.descriptors[rows_to], axis=1).sum(axis=1)
    assert differing.max() <= 16 < MAX_DISTANCE  # eight bits of noise on each side
    assert np.isfinite(new.points_base[rows_from]).all()


def test_swapping_the_views_inverts_the_transform() -> None:
    new, old, _ = two_views(2)
    there, back = register(new, old, CAMERA, PARAMS), register(old, new, CAMERA, PARAMS)
    assert there.T_from_to is not None
    assert back.T_from_to is not None
    np.testing.assert_allclose(there.T_from_to @ back.T_from_to, np.eye(4), atol=0.02)


def test_two_places_are_refused_with_the_number_of_matches() -> None:
    new, _, _ = two_views(1)
    other, _, _ = two_views(2)
    found = register(new, other, CAMERA, PARAMS)
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.test == "Vis/MinInliers"
    assert found.refusal.value == len(found.matches) < found.refusal.threshold == 20
    assert found.refusal.text == f"{len(found.matches)} matches, fewer than Vis/MinInliers 20"
    assert (found.covariance.diagonal() == UNKNOWN_VARIANCE).all()


def test_looks_without_geometry_are_refused_with_the_number_of_inliers() -> None:
    new, old, _ = two_views(3)
    pixels = np.random.default_rng(0).permutation(old.pixels)
    mixed = Features(pixels, old.sizes, old.angles, old.responses, old.octaves, old.descriptors, old.points_base)
    found = register(new, mixed, CAMERA, PARAMS)
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.text.endswith("inliers, fewer than Vis/MinInliers 20")
    assert found.refusal.value == found.inliers.sum() < 20 <= len(found.matches)


@pytest.mark.parametrize("which", ["new", "old", "both", "no depth"])
def test_a_view_that_shows_nothing_is_refused(which: str) -> None:
    new, old, _ = two_views(4)
    nothing = new.take(np.zeros(0, np.int64))
    if which == "no depth":
        new, _, _ = two_views(4, depth=0.0)
    found = register(
        nothing if which in ("new", "both") else new, nothing if which in ("old", "both") else old, CAMERA, PARAMS
    )
    assert found.T_from_to is None
    assert found.refusal is not None
    assert found.refusal.value == 0


@pytest.mark.parametrize("least", [4, 30, 80])
def test_the_threshold_is_the_parameter(least: int) -> None:
    new, old, _ = two_views(5, 60)
    found = register(new, old, CAMERA, PARAMS.changed({"Vis/MinInliers": least}))
    assert (found.refusal is None) == (least < 80)
    if found.refusal is not None:
        assert found.refusal.threshold == least


def test_the_old_view_needs_no_depth() -> None:
    new, _, T_from_to = two_views(6)
    _, old, _ = two_views(6, depth=0.0)
    found = register(new, old, CAMERA, PARAMS)
    assert found.T_from_to is not None
    assert translation_norm(between(T_from_to, found.T_from_to)) < 0.05
    assert (found.covariance.diagonal() < UNKNOWN_VARIANCE).all()
