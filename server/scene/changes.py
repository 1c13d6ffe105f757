"""What a change makes of the state of a 3D view."""

from __future__ import annotations

from typing import Any

from server.schemas.scene import Scene, SceneChange

#: Null is a value of these; of all others it leaves what is there.
_CAN_BE_NULL = frozenset(name for name, field in Scene.model_fields.items() if field.default is None)


def changed(state: Scene, change: SceneChange) -> Scene:
    """The next state, in which selecting a node deselects a link, and the reverse; ``state`` stays as it is."""
    named = {name: getattr(change, name) for name in change.model_fields_set - {"layers"}}
    values: dict[str, Any] = {name: value for name, value in named.items() if value is not None or name in _CAN_BE_NULL}
    if change.layers is not None:
        values["layers"] = state.layers.model_copy(update=change.layers.model_dump(exclude_none=True))
    if "at" in values:
        # Where nodes of then stand is known when they are drawn; until then it is said of the moment before.
        values |= {"placing_note": ""} if change.at is not None else {"placing_note": "", "placing": "now"}
    if change.selected_node is not None:
        values.setdefault("selected_link", None)
    elif change.selected_link is not None:
        values["selected_node"] = None
    return state.model_copy(update=values | {"revision": state.revision + 1})
