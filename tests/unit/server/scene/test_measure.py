"""Sizes suit the map."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from server.scene.measure import Measure


@given(st.floats(0.0, 500.0), st.integers(0, 200))
def test_a_node_is_seen_on_the_whole_map_and_small_beside_it(length: float, count: int) -> None:
    positions = np.column_stack([np.linspace(0.0, length, count), np.zeros((count, 2))])
    measure = Measure.of(positions)
    assert 1 / 400 < measure.node / measure.extent < 1 / 140
    assert measure.frustum > 2 * measure.node
    assert measure.extent >= (length if count > 1 else 0.0)


def test_wide_maps_have_wider_cells() -> None:
    near, far = (Measure.of(np.array([[0.0, 0, 0], [d, 0, 0]])) for d in (10.0, 400.0))
    assert near.cell < far.cell
