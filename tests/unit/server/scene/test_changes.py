"""A change names what becomes otherwise; all else stays."""

from __future__ import annotations

from typing import Any

import pytest

from server.scene.changes import changed
from server.schemas.scene import Scene, SceneChange, SceneLayers

BEFORE = Scene(
    layers=SceneLayers(grid=True),
    colour="memory",
    selected_node=3,
    what_if=0.2,
    trial=4,
    overlay="link",
    at=9,
    hidden_sessions=[1],
    placing="then",
    placing_note="lost",
    revision=5,
)


@pytest.mark.parametrize(
    ("change", "otherwise"),
    [
        ({}, {}),
        ({"layers": {"cloud": False}}, {"layers": SceneLayers(grid=True, cloud=False)}),
        ({"colour": None, "dark": None, "alone": None, "node_parts": None, "hidden_sessions": None}, {}),
        ({"what_if": None, "trial": None, "overlay": None}, {"what_if": None, "trial": None, "overlay": None}),
        ({"hidden_sessions": [], "dark": False}, {"hidden_sessions": [], "dark": False}),
        ({"at": 8}, {"at": 8, "placing_note": ""}),
        ({"at": None}, {"at": None, "placing": "now", "placing_note": ""}),
        ({"selected_link": [2, 1]}, {"selected_node": None, "selected_link": [2, 1]}),
        ({"selected_node": 4, "selected_link": [2, 1]}, {"selected_node": 4, "selected_link": [2, 1]}),
        ({"selected_node": None}, {"selected_node": None}),
    ],
)
def test_only_what_is_named_changes(change: dict[str, Any], otherwise: dict[str, Any]) -> None:
    kept = BEFORE.model_dump()
    after = changed(BEFORE, SceneChange(**change))
    assert after.model_dump() == BEFORE.model_copy(update={**otherwise, "revision": 6}).model_dump()
    assert BEFORE.model_dump() == kept


def test_a_node_takes_the_place_of_a_link() -> None:
    linked = changed(BEFORE, SceneChange(selected_link=[2, 1]))
    assert changed(linked, SceneChange(selected_node=7)).selected_link is None
