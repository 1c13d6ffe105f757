"""Features of an image: what is kept, where, and when a depth is believed."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.extract import Extractor
from slam.params import Params
from slam.types import Features, Frame

CAMERA = Camera(200, 160, 164.0, 164.0, 99.5, 79.5)
#: Top left corners of the squares of the picture below.
SQUARES = [(40, 40), (120, 40), (40, 100), (120, 100)]
SIDE = 30
PARAMS = Params()


def frame(depth_m: float | NDArray[np.float32] = 2.0, image: NDArray[np.uint8] | None = None) -> Frame:
    """Four bright squares on dark ground, at one depth unless told otherwise."""
    if image is None:
        image = np.full((160, 200, 3), 40, np.uint8)
        for x, y in SQUARES:
            image[y : y + SIDE, x : x + SIDE] = 220
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), 1.0), np.uint8)
    depth = np.full((160, 200), depth_m, np.float32) if isinstance(depth_m, float) else depth_m
    return Frame(0, 0.0, image, depth, CAMERA)


def extract(seen: Frame, **changes: float) -> Features:
    params = PARAMS.changed({name.replace("_", "/"): value for name, value in changes.items()})
    return Extractor().extract(seen, params)


def noise(seed: int = 0) -> NDArray[np.uint8]:
    grain = np.random.default_rng(seed).integers(0, 256, (160, 200, 3)).astype(np.uint8)
    return np.asarray(cv2.GaussianBlur(grain, (0, 0), 1.5), np.uint8)


def test_corners_of_squares_are_found() -> None:
    found = extract(frame(), GFTT_QualityLevel=0.2).pixels
    true = [(x + dx - 0.5, y + dy - 0.5) for x, y in SQUARES for dx in (0, SIDE) for dy in (0, SIDE)]
    assert len(found) == len(true)
    for corner in true:
        assert np.linalg.norm(found - corner, axis=1).min() < 2.0  # the blur draws them inwards


def test_key_points_are_spread_limited_and_strongest_first() -> None:
    features = extract(frame(image=noise()), Vis_MaxFeatures=50, GFTT_MinDistance=9)
    apart = np.linalg.norm(features.pixels[:, None] - features.pixels[None], axis=2) + 99 * np.eye(50)
    assert len(features) == 50
    assert apart.min() >= 9 - 1.5  # both may be refined by half a pixel along x and y
    assert (np.diff(features.responses) <= 0).all()


def test_a_stricter_quality_level_keeps_only_strong_corners() -> None:
    loose, strict = (extract(frame(image=noise()), GFTT_QualityLevel=level).responses for level in (0.001, 0.5))
    assert 0 < len(strict) < len(loose)
    assert strict.min() >= 0.5 * loose.max()


def test_key_points_keep_away_from_the_border() -> None:
    pixels = extract(frame(image=noise())).pixels
    assert 19.5 <= pixels.min() < 21
    assert (pixels <= np.array([200, 160]) - 20.5).all()


@pytest.mark.parametrize("size", [(160, 200), (30, 30), (40, 200)])
def test_an_image_without_corners_gives_none(size: tuple[int, int]) -> None:
    blank = Frame(0, 0.0, np.full((*size, 3), 128, np.uint8), np.ones(size, np.float32), CAMERA)
    features = Extractor().extract(blank, PARAMS)
    assert len(features) == 0
    assert features.descriptors.shape == (0, 32)
    assert features.points_base.shape == (0, 3)


def test_points_lie_on_the_rays_of_their_pixels_at_the_depth_seen() -> None:
    features = extract(frame(2.0))
    x, y, z = features.points_base.T
    np.testing.assert_allclose(x, 2.0, atol=1e-6)  # forward in the base frame is the camera's z
    np.testing.assert_allclose(-y / x * CAMERA.fx + CAMERA.cx, features.pixels[:, 0], atol=1e-3)
    np.testing.assert_allclose(-z / x * CAMERA.fy + CAMERA.cy, features.pixels[:, 1], atol=1e-3)


@pytest.mark.parametrize(("depth", "kept"), [(0.0, False), (0.4, False), (0.6, True), (3.0, True), (3.1, False)])
def test_depth_counts_between_the_limits_only(depth: float, kept: bool) -> None:
    features = extract(frame(depth), Vis_MinDepth=0.5, Vis_MaxDepth=3.0)
    assert np.isfinite(features.points_base).all() == kept
    assert np.isfinite(features.points_base).any() == kept
    assert len(features) > 0


def test_depth_at_an_edge_is_not_believed_and_a_small_hole_is_filled() -> None:
    found = extract(frame())
    x, y = np.rint(found.pixels[0]).astype(int)
    depth = np.full((160, 200), 2.0, np.float32)
    depth[y, x] = 0.0
    assert extract(frame(depth)).points_base[0, 0] == pytest.approx(2.0, abs=1e-6)
    depth[y, x - 1] = 2.2  # a tenth farther: the border of something
    assert np.isnan(extract(frame(depth)).points_base[0]).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_depth_that_is_no_number_counts_as_unknown(bad: float) -> None:
    assert np.isnan(extract(frame(np.full((160, 200), bad, np.float32))).points_base).all()


def test_the_same_corner_moved_has_the_same_descriptor() -> None:
    grain = noise()
    moved = np.roll(grain, (3, 5), (0, 1))
    first, second = extract(frame(image=grain)), extract(frame(image=moved))
    apart = np.linalg.norm(first.pixels[:, None] - (second.pixels - (5, 3))[None], axis=2)
    rows, others = np.nonzero(apart < 0.01)
    assert len(rows) > 50
    np.testing.assert_array_equal(first.descriptors[rows], second.descriptors[others])


def test_the_input_is_not_changed() -> None:
    depth = np.random.default_rng(0).uniform(-1, 3, (160, 200)).astype(np.float32)
    seen = frame(depth)
    before = replace(seen, image_bgr=seen.image_bgr.copy(), depth_m=depth.copy())
    extract(seen)
    np.testing.assert_array_equal(seen.image_bgr, before.image_bgr)
    np.testing.assert_array_equal(seen.depth_m, before.depth_m)
