"""Lines are sent when they change, and dashes stay where they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from server.scene.lines import PIECE, Lines, chain, dashed
from tests.unit.server.scene.conftest import Sent

GREY = (128, 128, 128)


def wander(count: int) -> Any:
    return np.cumsum(np.random.default_rng(0).normal(size=(count, 3)), axis=0)


@given(st.integers(2, 60), st.floats(0.05, 2.0))
def test_dashes_lie_on_the_path_cover_about_half_of_it_and_stay_when_it_grows(count: int, dash: float) -> None:
    path = np.column_stack([np.linspace(0.0, float(count), count), np.zeros(count), np.ones(count)])
    dashes = dashed(path, dash)
    lengths = np.linalg.norm(dashes[:, 1] - dashes[:, 0], axis=1)
    assert (lengths <= dash + 1e-9).all()
    assert abs(lengths.sum() - 0.5 * count) <= dash + 1e-9
    np.testing.assert_allclose(dashes[:, :, 1:], [[[0.0, 1.0]] * 2] * len(dashes))
    longer = dashed(np.vstack([path, [count + 3.0, 0.0, 1.0]]), dash)
    np.testing.assert_allclose(longer[: len(dashes) - 1], dashes[:-1], atol=1e-9)


def test_a_long_path_gets_longer_dashes_rather_than_too_many() -> None:
    path = np.array([[0.0, 0.0, 0.0], [1000.0, 0.0, 0.0]])
    assert 250 <= len(dashed(path, 0.01, most=500)) <= 500


@pytest.mark.parametrize("points", [0, 1])
def test_there_is_no_line_through_less_than_two_points(points: int) -> None:
    assert dashed(np.zeros((points, 3)), 1.0).shape == (0, 2, 3)
    assert chain(np.zeros((points, 3))).shape == (0, 2, 3)


def test_only_what_is_new_is_sent(viewer: Any, sent: Sent) -> None:
    lines, path = Lines(viewer.scene, "/lines", 1.0), wander(2 * PIECE + 10)
    lines.draw(chain(path), GREY)
    sent.take()
    lines.draw(chain(path), GREY)
    assert sent.take() == []
    lines.draw(chain(np.vstack([path, path[:1]])), GREY)
    assert sent.take() == [("update points", "/lines/2")]
    lines.draw(chain(path[:PIECE]), GREY, visible=False)
    assert {kind for kind, _ in sent.take()} == {"SetSceneNodeVisibility"}
    lines.draw(chain(path[:PIECE]), GREY)
    kinds = {kind for kind, name in sent.take() if name != "/lines/0"}
    assert kinds == {"SetSceneNodeVisibility", "RemoveSceneNode"}
    lines.draw(chain(path[:1]), GREY)
    assert ("RemoveSceneNode", "/lines/0") in sent.take()
