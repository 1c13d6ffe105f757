"""The nearest places are those that a look at each in turn would find."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from slam.memory.places import Places
from tests.nodes import at


@given(
    xs=st.lists(st.integers(-20, 20), min_size=1, max_size=40),
    gone=st.sets(st.integers(0, 39)),
    count=st.integers(0, 6),
    radius=st.floats(0.5, 30),
)
def test_it_finds_what_a_look_at_each_would(xs: list[int], gone: set[int], count: int, radius: float) -> None:
    poses = {k + 1: at(float(x), 0.5 * x) for k, x in enumerate(xs)}
    places = Places()
    places.put(poses, poses)
    for k in sorted(gone):
        if k + 1 in poses:
            places.drop([k + 1])
            del poses[k + 1]
    away = {i: float(np.linalg.norm(T[:3, 3])) for i, T in poses.items()}
    expected = [i for i in sorted(away, key=lambda i: (away[i], i)) if away[i] <= radius][:count]
    assert places.nearest(np.zeros(3), count, radius) == expected
    assert len(places) == len(poses)


def test_places_move_and_grow_in_number() -> None:
    poses = {i: at(float(i)) for i in range(1, 3001)}
    places = Places()
    places.put(poses, poses)
    assert places.nearest(np.array([2500.2, 0.0, 0.0]), 2, 10.0) == [2500, 2501]
    places.put({7: at(2500.3)}, [7])
    assert places.nearest(np.array([2500.2, 0.0, 0.0]), 2, 10.0) == [7, 2500]
    assert len(places) == 3000
