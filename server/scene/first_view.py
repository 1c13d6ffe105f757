"""Where a browser looks from when it opens a map."""

from __future__ import annotations

import numpy as np
import viser

from server.scene.model import Array, SceneModel

_FOV = float(np.radians(50.0))
#: From behind, a little to the right, well above.
_FROM = np.array([-0.62, -0.66, 0.78])
#: An empty map is taken for a room of this radius in front of the camera.
_ROOM_METRES = 3.0
_FEW = 8


def set_first_view(server: viser.ViserServer, model: SceneModel) -> None:
    """Let a new browser see the whole map; one that looks already keeps its view."""
    centre, radius = _extent(model)
    distance = radius / np.sin(_FOV / 2)
    server.initial_camera.fov = _FOV
    server.initial_camera.look_at = centre
    server.initial_camera.position = centre + _FROM / np.linalg.norm(_FROM) * distance
    server.initial_camera.up = np.array([0.0, 0.0, 1.0])


def _extent(model: SceneModel) -> tuple[Array, float]:
    """Centre and radius of what is seen from the nodes."""
    if len(model.ids) < _FEW:
        return np.array([1.5, 0.0, 0.0]), _ROOM_METRES
    ahead = model.positions + model.T_map_base[:, :3, 0] * 1.5
    points = np.concatenate([model.positions, ahead])
    low, high = np.percentile(points, 2, axis=0), np.percentile(points, 98, axis=0)
    return (low + high) / 2, max(0.8, 0.55 * float(np.linalg.norm((high - low)[:2])))
