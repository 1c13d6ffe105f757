"""A transform from picked points: exact for exact points, refused for points on a line, by depth of the images."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from slam.camera import Camera
from slam.edit.point_pairs import fitted, lifted
from slam.edit.wishes import PickedPair
from slam.errors import DatabaseError, DecisionError
from slam.geometry import se3_exp, transform

ANY = st.lists(st.floats(-1.5, 1.5), min_size=6, max_size=6)


@given(tangent=ANY, seed=st.integers(0, 10_000), count=st.integers(3, 8))
def test_exact_pairs_give_the_transform(tangent: list[float], seed: int, count: int) -> None:
    T = se3_exp(np.array(tangent))
    points = np.vstack([np.eye(3), np.random.default_rng(seed).uniform(-2, 2, (count - 3, 3))])
    found = fitted(transform(T, points), points)
    assert np.allclose(found.T_from_to, T, atol=1e-9)
    assert found.residuals_m.max() < 1e-9
    assert np.linalg.eigvalsh(found.information).min() > 0, "three points off a line fix all six axes"


def test_worse_points_are_trusted_less_and_say_how_far_they_are_off() -> None:
    points = np.vstack([np.eye(3), [[1.0, 1.0, 1.0]]])
    moved = points.copy()
    moved[1, 1] += 0.2
    exact, rough = fitted(points, points), fitted(moved, points)
    assert rough.residuals_m.max() > 0.05
    assert np.trace(rough.information) < 0.1 * np.trace(exact.information)


def test_too_few_points_and_points_on_a_line_are_refused() -> None:
    line = np.outer(np.arange(4.0), [1.0, 1.0, 0.0])
    with pytest.raises(DecisionError, match="at least 3"):
        fitted(np.eye(3)[:2], np.eye(3)[:2])
    with pytest.raises(DecisionError, match="one line"):
        fitted(line, line)


class Pictures:
    """Two nodes with a wall at 2 m, the second with a hole in its depth; depth has half the size of the images."""

    def cameras(self, node_id: int) -> tuple[Camera, ...]:
        return (Camera(64, 48, 50.0, 50.0, 31.5, 23.5),) * (2 if node_id == 3 else 1)

    def depth_m(self, node_id: int) -> np.ndarray:
        depth = np.full((24, 64 if node_id == 3 else 32), 2.0, np.float32)
        if node_id == 2:
            depth[:, 16:] = 0.0
        return depth


def test_pixels_become_points_of_the_base_frame() -> None:
    points_from, points_to = lifted(Pictures(), 1, 2, [PickedPair((31.5, 23.5), (6.5, 23.5))])
    assert np.allclose(points_from, [[2.0, 0.0, 0.0]])
    assert np.allclose(points_to, [[2.0, 1.0, 0.0]])
    right, _ = lifted(Pictures(), 3, 1, [PickedPair((64 + 31.5, 23.5), (1, 1))])
    assert np.allclose(right, [[2.0, 0.0, 0.0]]), "the tile of the second camera"


class NoPictures:
    """A node of a scanner."""

    def cameras(self, node_id: int) -> tuple[Camera, ...]:
        raise DatabaseError(f"node {node_id} has no calibration")

    def depth_m(self, node_id: int) -> np.ndarray:
        raise DatabaseError(f"node {node_id} has no depth image")


def test_points_of_clouds_are_taken_as_they_are_and_go_with_pixels() -> None:
    a, b = lifted(
        Pictures(), 1, 2, [PickedPair((31.5, 23.5), (1.0, 2.0, 3.0)), PickedPair((4.0, 5.0, 6.0), (6.5, 23.5))]
    )
    np.testing.assert_allclose(a, [[2.0, 0.0, 0.0], [4.0, 5.0, 6.0]])
    np.testing.assert_allclose(b, [[1.0, 2.0, 3.0], [2.0, 1.0, 0.0]])
    alone, _ = lifted(NoPictures(), 1, 2, [PickedPair((1.0, 2.0, 3.0), (1.0, 2.0, 3.0))])
    np.testing.assert_allclose(alone, [[1.0, 2.0, 3.0]])
    with pytest.raises(DatabaseError, match="no calibration"):
        lifted(NoPictures(), 1, 2, [PickedPair((1.0, 2.0), (1.0, 2.0, 3.0))])


@pytest.mark.parametrize(("pair", "why"), [((1, 1, 60, 20), "pair 1: node 2 has no depth"), ((70, 1, 1, 1), "outside")])
def test_pixels_without_depth_or_outside_are_named(pair: tuple[float, ...], why: str) -> None:
    with pytest.raises(DecisionError, match=why):
        lifted(Pictures(), 1, 2, [PickedPair(pair[:2], pair[2:])])
