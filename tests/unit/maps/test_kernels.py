"""The compiled loops on small arrays whose answer is plain."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.maps.kernels import grow_ground, normals, trace_rays


def test_ground_grows_up_a_ramp_and_not_onto_a_table() -> None:
    height = np.array([[0.0, 0.05, 0.1, 0.15, 0.2, 0.9, 0.9, 0.25]])
    flat = np.ones((1, 8), np.bool_)
    assert np.array_equal(grow_ground(flat, height, 0.0, 0.02, 0.1), [[1, 1, 1, 1, 1, 0, 0, 0]])
    flat[0, 2] = False
    assert np.array_equal(grow_ground(flat, height, 0.0, 0.02, 0.1), [[1, 1, 0, 0, 0, 0, 0, 0]])
    assert not grow_ground(flat, height, np.nan, 0.02, 0.1).any()


def test_rays_end_at_the_first_obstacle() -> None:
    obstacle = np.zeros((5, 9), np.bool_)
    obstacle[2, 5] = obstacle[2, 8] = True
    free = trace_rays(obstacle, 2.5, 0.5)
    assert np.array_equal(np.argwhere(free), [[2, k] for k in range(5)])


@given(st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(1.0, 4.0))
def test_normals_of_a_plane_are_exact_and_face_the_camera(a: float, b: float, distance: float) -> None:
    x, y = np.linspace(-0.3, 0.3, 31, dtype=np.float32), np.linspace(-0.2, 0.2, 21, dtype=np.float32)
    n = np.array([a, b, -1.0]) / np.sqrt(a * a + b * b + 1.0)
    depth = -distance / (n[0] * x + n[1] * y[:, None] + n[2])
    normal, found = normals(depth.astype(np.float32), x, y)
    assert np.all(found == 2)
    assert np.allclose(normal, n, atol=2e-3)


def test_no_depth_is_no_surface_and_a_thin_one_has_no_normal() -> None:
    depth = np.zeros((9, 9), np.float32)
    x = np.linspace(-0.1, 0.1, 9, dtype=np.float32)
    assert not normals(depth, x, x)[1].any()
    depth[:, 4] = 1.0
    found = normals(depth, x, x)[1]
    assert np.array_equal(np.unique(found), [0, 1])
    assert found[4, 4] == 1
