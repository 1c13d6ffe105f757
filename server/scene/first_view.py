"""Where a browser looks from when it opens a map, and how high the floor is."""

from __future__ import annotations

import numpy as np
import viser

from server.scene.model import Array, SceneModel

_FOV = float(np.radians(50.0))
#: From behind, a little to the right, well above.
_FROM = np.array([-0.55, -0.62, 0.86])
#: An empty map is taken for a room of this radius in front of the camera.
_ROOM_METRES = 3.0
_FEW = 8
_EYE_METRES = 1.2
#: Nearer than a ball of that radius would need: maps are flat, and seen from above at a slant.
_CLOSE = 0.86


def set_first_view(server: viser.ViserServer, model: SceneModel, around: Array) -> None:
    """Let a new browser see the whole map; one that looks already keeps its view.

    Args:
        server: whose scene it is.
        model: the nodes.
        around: (N, 3) points seen from some of them.
    """
    centre, radius = _extent(model, around)
    distance = _CLOSE * radius / np.sin(_FOV / 2)
    server.initial_camera.fov = _FOV
    server.initial_camera.look_at = centre
    server.initial_camera.position = centre + _FROM / np.linalg.norm(_FROM) * distance
    server.initial_camera.up = np.array([0.0, 0.0, 1.0])


def floor_height(model: SceneModel, around: Array) -> float:
    """Height that nearly everything seen is above; without anything seen, an eye's height below the lowest node."""
    if len(around):
        return float(np.percentile(around[:, 2], 2))
    return float(model.positions[:, 2].min()) - _EYE_METRES if len(model.ids) else -_EYE_METRES


def _extent(model: SceneModel, around: Array) -> tuple[Array, float]:
    """Centre and radius of the nodes and of what is seen from them."""
    if len(model.ids) < _FEW:
        return np.array([1.0, 0.0, 0.0]), _ROOM_METRES
    low, high = model.positions.min(axis=0), model.positions.max(axis=0)
    if len(around):
        # Single points far away, and whatever is high above, don't count.
        near, far = np.percentile(around, 4, axis=0), np.percentile(around, 96, axis=0)
        low, high = np.minimum(low, near), np.maximum(high, far)
    return (low + high) / 2, max(0.4, 0.5 * float(np.linalg.norm((high - low)[:2])))
