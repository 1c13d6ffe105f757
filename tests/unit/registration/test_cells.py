"""Points by cells: the nearest ones are the nearest ones, thinning keeps means, normals are the planes'."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial import KDTree

from slam.registration.cells import nearest, normals, sort, thinned

quickly = settings(max_examples=25)
seeds = st.integers(0, 10_000)


def cloud(seed: int, count: int, spread: float = 1.0) -> NDArray[np.float64]:
    return np.random.default_rng(seed).normal(size=(count, 3)) * spread


@quickly
@given(seeds, st.floats(0.02, 0.5), st.sampled_from([1.0, 0.6]))
def test_the_nearest_is_what_a_search_through_all_finds(seed: int, size: float, share: float) -> None:
    points, queries = cloud(seed, 200), cloud(seed + 1, 80)
    rows, squared = nearest(sort(points, size), queries, share * size)
    distance, expected = KDTree(points).query(queries)
    within = distance <= share * size
    np.testing.assert_array_equal(rows, np.where(within, expected, -1))
    np.testing.assert_allclose(squared[within], distance[within] ** 2, rtol=1e-9, atol=1e-15)
    assert np.isinf(squared[~within]).all()


@quickly
@given(seeds, st.floats(0.05, 2.0))
def test_each_cube_leaves_the_mean_of_its_points_and_thinning_twice_changes_nothing(seed: int, size: float) -> None:
    points = cloud(seed, 150)
    fewer = thinned(points, size)
    cube = np.floor(points / size)
    expected = {tuple(c): points[(cube == c).all(axis=1)].mean(axis=0) for c in cube}
    assert len(fewer) == len(expected)
    for point in fewer:
        np.testing.assert_allclose(point, expected[tuple(np.floor(point / size))], atol=1e-12)
    np.testing.assert_allclose(thinned(fewer, size), fewer)


@quickly
@given(seeds, st.integers(3, 12))
def test_normals_are_those_of_the_nearest_points_plane(seed: int, k: int) -> None:
    points = cloud(seed, 120, 0.2) + np.array([2.0, 0.0, 0.0])
    found = normals(sort(points, 0.15), k)
    known = np.flatnonzero(np.isfinite(found[:, 0]))
    distances, rows = KDTree(points).query(points, k=k)
    assert len(known)
    for i in known:
        if distances[i, -1] > 0.3:
            continue
        near = points[rows[i]] - points[rows[i]].mean(axis=0)
        values, vectors = np.linalg.eigh(near.T @ near)
        if values[1] > 1.01 * values[0]:
            np.testing.assert_allclose(abs(vectors[:, 0] @ found[i]), 1.0, atol=1e-5)
        assert found[i] @ points[i] <= 0, "towards the sensor"


def test_points_on_a_line_or_alone_have_no_normal() -> None:
    line = np.column_stack([np.arange(10) * 0.02, np.zeros(10), np.zeros(10)])
    alone = np.array([[9.0, 9.0, 9.0]])
    assert np.isnan(normals(sort(np.concatenate([line, alone]), 0.1), 5)).all()
