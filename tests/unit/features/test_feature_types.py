"""Every feature type finds the same things again, where it is told to look."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from slam.camera import Camera
from slam.errors import ParameterError
from slam.features.extract import Extractor
from slam.features.match import match_all
from slam.features.orb_octree import spread_by_quadtree
from slam.params import Effect, Params, Value, spec
from slam.params import feature_types as numbers
from slam.types import Features, Frame

CAMERA = Camera(320, 240, 262.0, 262.0, 159.5, 119.5)
#: Type -> kind and width of its descriptors.
WIDTHS = {
    0: ("float32", 64),
    1: ("float32", 128),
    2: ("uint8", 32),
    3: ("uint8", 64),
    4: ("uint8", 32),
    5: ("uint8", 64),
    6: ("uint8", 32),
    7: ("uint8", 64),
    8: ("uint8", 32),
    9: ("float32", 64),
    10: ("uint8", 32),
    12: ("uint8", 64),
    13: ("float32", 200),
    14: ("float32", 200),
}
SHIFT = (7, 4)


def picture(seed: int = 0, *, contrast: float = 1.0) -> NDArray[np.uint8]:
    """Blots of several sizes."""
    rng = np.random.default_rng(seed)
    scene = np.zeros((240, 320))
    for sigma in (1.5, 3.0, 6.0):
        grain = cv2.GaussianBlur(rng.normal(size=(240, 320)), (0, 0), sigma)
        scene += grain / grain.std()
    grey = np.clip(128 + 30 * contrast * scene, 0, 255).astype(np.uint8)
    return np.repeat(grey[:, :, None], 3, axis=2)


def frame(image: NDArray[np.uint8]) -> Frame:
    return Frame(0, 0.0, image, np.full(image.shape[:2], 2.0, np.float32), CAMERA)


def extract(image: NDArray[np.uint8], changes: dict[str, Value]) -> Features:
    return Extractor().extract(frame(image), Params().changed(changes))


def test_the_table_above_is_complete() -> None:
    assert tuple(WIDTHS) == numbers.FEATURE_TYPES


@pytest.mark.parametrize("number", WIDTHS)
def test_a_type_keeps_the_rules_of_all_types(number: int) -> None:
    found = extract(picture(), {"Vis/FeatureType": number, "Vis/MaxFeatures": 60})
    assert 10 <= len(found) <= 60
    assert (found.descriptors.dtype.name, found.descriptors.shape[1]) == WIDTHS[number]
    assert (np.diff(found.responses) <= 0).all(), "strongest first"
    assert (found.pixels >= 2).all() and (found.pixels <= (317, 237)).all()
    assert (found.sizes > 0).all()
    assert np.isfinite(found.points_base).all()
    columns = ("pixels", "sizes", "angles", "responses", "octaves", "descriptors", "points_base")
    assert {len(getattr(found, name)) for name in columns} == {len(found)}
    dtypes = [getattr(found, name).dtype.name for name in columns if name != "descriptors"]
    assert dtypes == ["float32", "float32", "float32", "float32", "int32", "float32"]


@pytest.mark.parametrize("number", WIDTHS)
def test_a_type_finds_and_matches_what_has_moved(number: int) -> None:
    image = picture()
    changes: dict[str, Value] = {"Vis/FeatureType": number, "Vis/MaxFeatures": 300}
    first = extract(image, changes)
    second = extract(np.roll(image, SHIFT[::-1], (0, 1)), changes)
    matches = match_all(first.descriptors, second.descriptors, ratio=0.8)
    moved = second.pixels[matches[:, 1]] - first.pixels[matches[:, 0]]
    right = np.linalg.norm(moved - SHIFT, axis=1) < 1.5
    assert right.sum() > 0.4 * len(first)
    assert right.mean() > 0.9


@pytest.mark.parametrize("number", WIDTHS)
def test_an_image_without_anything_gives_no_key_points(number: int) -> None:
    none = extract(np.full((240, 320, 3), 128, np.uint8), {"Vis/FeatureType": number})
    assert len(none) == 0
    assert (none.descriptors.dtype.name, none.descriptors.shape) == (WIDTHS[number][0], (0, WIDTHS[number][1]))


@pytest.mark.parametrize("number", [1, 3, 8, 10, 12])
def test_no_key_point_lies_in_the_border_that_is_left_out(number: int) -> None:
    changes: dict[str, Value] = {"Vis/FeatureType": number, "Vis/RoiRatios": "0.25 0.125 0.2 0.4"}
    found = extract(picture(), changes).pixels
    assert len(found) > 20
    low, high = found.min(axis=0), found.max(axis=0)
    assert (low >= (79.5, 47.5)).all() and (high <= (280.5, 144.5)).all()
    assert (low <= (110, 80)).all() and (high >= (250, 115)).all()


@pytest.mark.parametrize("number", [1, 2, 4, 8])
def test_a_grid_gives_faint_parts_their_share(number: int) -> None:
    image = np.hstack([picture()[:, :160], picture(1, contrast=0.4)[:, 160:]])
    changes: dict[str, Value] = {"Vis/FeatureType": number, "Vis/MaxFeatures": 60, "GFTT/QualityLevel": 0.3}
    spread = extract(image, {**changes, "Vis/GridCols": 2, "Vis/GridRows": 2}).pixels
    plain = extract(image, changes).pixels
    assert (plain[:, 0] > 164).sum() < 0.3 * len(plain)
    corners = spread[:, 0].astype(int) // 160 + 2 * (spread[:, 1].astype(int) // 120)
    assert np.bincount(corners, minlength=4).max() <= 16, "a fourth each, up to half a pixel"
    assert ((spread[:, 0] > 159).sum()) >= 20


def test_sub_pixel_search_finds_corners_more_exactly() -> None:
    image = np.full((240, 320), 60, np.uint8)
    for x in range(40, 280, 60):
        image[60:180, x : x + 30] = 200
    image = np.asarray(cv2.warpAffine(image, np.array([[1, 0, 0.3], [0, 1, 0.4]]), (320, 240)), np.uint8)
    true = np.array([(x + dx - 0.2, y) for x in range(40, 280, 60) for dx in (0, 30) for y in (59.9, 179.9)])

    def error(iterations: int) -> float:
        changes: dict[str, Value] = {"Vis/SubPixIterations": iterations, "GFTT/QualityLevel": 0.2}
        found = extract(np.repeat(image[:, :, None], 3, axis=2), changes).pixels
        return float(np.linalg.norm(found[None] - true[:, None], axis=2).min(axis=1).max())

    assert 2 * error(20) < error(0), (error(20), error(0))


@pytest.mark.parametrize("sigma", [3.0, 4.0, 6.0])
def test_surf_blobs_are_found_to_a_tenth_of_a_pixel(sigma: float) -> None:
    y, x = np.mgrid[:240, :320]
    blob = 40 + 180 * np.exp(-((x - 170.3) ** 2 + (y - 105.6) ** 2) / (2 * sigma**2))
    found = extract(np.repeat(blob.round().astype(np.uint8)[:, :, None], 3, axis=2), {"Vis/FeatureType": 0})
    np.testing.assert_allclose(found.pixels[0], (170.3, 105.6), atol=0.1)
    assert found.sizes[0] == pytest.approx(5.2 * sigma, rel=0.15)  # a filter of 9 pixels is for sigma 1.2 after blur


@pytest.mark.parametrize("number", [0, 1, 2, 7, 9, 10])
def test_turned_images_match_where_the_type_turns_with_them(number: int) -> None:
    image = picture()
    first = extract(image, {"Vis/FeatureType": number, "Vis/MaxFeatures": 300})
    turned = np.ascontiguousarray(np.rot90(image, -1))
    second = extract(turned, {"Vis/FeatureType": number, "Vis/MaxFeatures": 300})
    back = np.column_stack([second.pixels[:, 1], 239 - second.pixels[:, 0]])
    matches = match_all(first.descriptors, second.descriptors, ratio=0.8)
    right = np.linalg.norm(back[matches[:, 1]] - first.pixels[matches[:, 0]], axis=1) < 2.0
    assert right.sum() > 0.2 * len(first)
    assert right.mean() > 0.65


def test_parameters_of_the_types_are_read() -> None:
    image = picture()
    ways: dict[str, tuple[int, Value]] = {
        "SIFT/ContrastThreshold": (1, 0.2),
        "SIFT/RootSIFT": (1, True),
        "ORB/NLevels": (2, 1),
        "ORB/ScaleFactor": (10, 1.2),
        "FAST/Threshold": (4, 60),
        "FREAK/OrientationNormalized": (5, False),
        "BRISK/Thresh": (7, 60),
        "KAZE/Upright": (9, True),
        "SURF/HessianThreshold": (0, 3000.0),
        "GFTT/UseHarrisDetector": (8, True),
        "ORB/PatchSize": (8, 21),
        "ORB/EdgeThreshold": (8, 40),
    }
    for name, (number, value) in ways.items():
        usual = extract(image, {"Vis/FeatureType": number})
        changed = extract(image, {"Vis/FeatureType": number, name: value})
        same = len(usual) == len(changed) and bool((usual.descriptors == changed.descriptors).all())
        assert not same, name
    assert extract(image, {"Vis/FeatureType": 6, "BRIEF/Bytes": 16}).descriptors.shape[1] == 16


def test_roots_of_sift_have_length_one() -> None:
    found = extract(picture(), {"Vis/FeatureType": 1, "SIFT/RootSIFT": True})
    np.testing.assert_allclose(np.linalg.norm(found.descriptors, axis=1), 1.0, atol=1e-4)


def test_a_change_of_parameters_is_taken_up() -> None:
    extractor, seen = Extractor(), frame(picture())
    steps: list[dict[str, Value]] = [
        {"Vis/FeatureType": 1},
        {"Vis/FeatureType": 2},
        {"Vis/FeatureType": 2, "ORB/NLevels": 1},
        {"Vis/FeatureType": 8},
    ]
    for changes in steps:
        params = Params().changed({**changes, "Vis/MaxFeatures": 50})
        again = Extractor().extract(seen, params)
        np.testing.assert_array_equal(extractor.extract(seen, params).descriptors, again.descriptors)


@pytest.mark.parametrize("name", ["Vis/FeatureType", "Kp/DetectorStrategy"])
@pytest.mark.parametrize(
    ("number", "why"),
    [(11, "SuperPoint.*PyTorch"), (15, "PyDetector.*Python file"), (16, "PyTorch"), (99, "no feature")],
)
def test_what_can_not_be_extracted_is_refused_with_the_reason(name: str, number: int, why: str) -> None:
    with pytest.raises(ParameterError, match=rf"{name}={number}: must be one of .*8 GFTT/ORB.*; {number} is .*{why}"):
        Params().changed({name: number})


def test_without_its_library_surf_is_refused_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numbers, "find_spec", lambda _: None)
    for number in (0, 12, 14):
        with pytest.raises(ParameterError, match=r"must be one of 1 SIFT, .*pip install mahotas"):
            Params().changed({"Kp/DetectorStrategy": number})


def test_types_change_with_the_next_session_only() -> None:
    assert spec("Vis/FeatureType").effect is spec("Kp/DetectorStrategy").effect is Effect.SESSION


@pytest.mark.parametrize("text", ["", "0 0 0", "0.5 0.5 0 0", "0 0 0.3 0.7", "-0.1 0 0 0", "a b c d", "0 0 0 nan"])
def test_a_border_that_leaves_nothing_is_refused(text: str) -> None:
    with pytest.raises(ParameterError, match="four shares"):
        Params().changed({"Vis/RoiRatios": text})


@pytest.mark.parametrize("limit", [1, 7, 50, 199])
def test_a_quadtree_keeps_its_limit_and_reaches_everywhere(limit: int) -> None:
    rng = np.random.default_rng(0)
    crowd = rng.uniform(0, 20, (150, 2))
    pixels = np.concatenate([crowd, rng.uniform(0, 300, (50, 2))]).astype(np.float32)
    rows = spread_by_quadtree(pixels, rng.uniform(size=200).astype(np.float32), limit)
    assert len(np.unique(rows)) == len(rows)
    assert max(1, limit - 3) <= len(rows) <= limit
    if limit == 50:
        assert (rows >= 150).sum() > 25, "the crowd in the corner gets few"


def test_depth_limits_of_words_are_their_own() -> None:
    params = Params().changed({"Vis/MaxDepth": 1.0, "Kp/MaxDepth": 3.0})
    seen = replace(frame(picture()))
    assert np.isnan(Extractor("Vis").extract(seen, params).points_base).all()
    assert np.isfinite(Extractor("Kp").extract(seen, params).points_base).all()


def test_a_quadtree_that_is_split_in_part_has_coarse_and_fine_cells() -> None:
    pixels = np.stack(np.meshgrid(np.arange(16), np.arange(16)), axis=-1).reshape(-1, 2).astype(np.float32)
    rows = spread_by_quadtree(pixels, np.ones(256, np.float32), 7)
    assert len(rows) == 7, "three quarters of the image, and four quarters of the first"
