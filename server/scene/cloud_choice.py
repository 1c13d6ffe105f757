"""Which nodes show their cloud: few enough to draw, spread over the whole map."""

from __future__ import annotations

import numpy as np

from server.scene.model import Array, SceneModel

MOST = 150
_TURN_METRES = 1.2
_FIRST_METRES = 0.25
_GROWTH = 1.3


class CloudChoice:
    """Chooses nodes that are some distance from each other; whoever is chosen stays as long as there is room.

    Two views from one place that look elsewhere count as far from each other: half a turn is worth some metres.
    """

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._spacing = _FIRST_METRES
        self._chosen: list[int] = []

    def choose(self, model: SceneModel) -> list[int]:
        """Ids of the nodes to show, in the order in which they were chosen."""
        places = _places(model)
        self._chosen = [node_id for node_id in self._chosen if node_id in model.rows]
        known = set(self._chosen)
        chosen = self._spread(self._chosen + [i for i in model.ids.tolist() if i not in known], model, places)
        while len(chosen) > self._most:
            self._spacing *= _GROWTH
            chosen = self._spread(chosen, model, places)
        self._chosen = chosen
        return list(chosen)

    def _spread(self, ids: list[int], model: SceneModel, places: Array) -> list[int]:
        kept: list[int] = []
        taken = np.zeros((0, places.shape[1]))
        for node_id in ids:
            place = places[model.rows[node_id]]
            if len(taken) and np.linalg.norm(taken - place, axis=1).min() < self._spacing:
                continue
            kept.append(node_id)
            taken = np.vstack([taken, place])
        return kept


def _places(model: SceneModel) -> Array:
    """(N, 6) position and, scaled, where it looks."""
    return np.hstack([model.positions, 0.5 * _TURN_METRES * model.T_map_base[:, :3, 0]])
