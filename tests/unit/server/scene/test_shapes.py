"""A ball is a closed surface that looks outwards."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from server.scene.shapes import ball, icosphere


@pytest.mark.parametrize("subdivisions", [0, 1, 2])
def test_a_ball_is_closed_round_and_faces_outwards(subdivisions: int) -> None:
    made = icosphere(subdivisions)
    assert len(made.faces) == 20 * 4**subdivisions
    np.testing.assert_allclose(np.linalg.norm(made.vertices, axis=1), 1.0)
    edges = Counter((int(face[i]), int(face[(i + 1) % 3])) for face in made.faces for i in range(3))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    a, b, c = (made.vertices[made.faces[:, i]] for i in range(3))
    assert (np.sum(np.cross(b - a, c - a) * a, axis=1) > 0).all()


@pytest.mark.parametrize(("count", "faces"), [(1, 320), (300, 320), (301, 80), (1500, 80), (1501, 20), (10_000, 20)])
def test_many_balls_have_fewer_faces_each(count: int, faces: int) -> None:
    assert len(ball(count).faces) == faces
    assert count * faces <= max(120_000, 20 * count)
