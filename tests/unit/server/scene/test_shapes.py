"""A ball is a closed surface that looks outwards."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from server.scene.shapes import icosphere


@pytest.mark.parametrize("subdivisions", [0, 1, 2])
def test_a_ball_is_closed_round_and_faces_outwards(subdivisions: int) -> None:
    ball = icosphere(subdivisions)
    assert len(ball.faces) == 20 * 4**subdivisions
    np.testing.assert_allclose(np.linalg.norm(ball.vertices, axis=1), 1.0)
    edges = Counter((int(face[i]), int(face[(i + 1) % 3])) for face in ball.faces for i in range(3))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    a, b, c = (ball.vertices[ball.faces[:, i]] for i in range(3))
    assert (np.sum(np.cross(b - a, c - a) * a, axis=1) > 0).all()
