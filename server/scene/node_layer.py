"""The nodes: one batch of small balls, coloured by memory, session, time or weight."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from server.scene import palette
from server.scene.model import SceneModel
from server.scene.shapes import sphere
from server.schemas import Colouring
from slam.types import Tier

OnPick = Callable[[int], None]
_RADIUS = 0.2


class NodeLayer:
    """Draws all nodes with one handle; moving them sends positions only."""

    def __init__(self, server: viser.ViserServer, on_pick: OnPick) -> None:
        self._server = server
        self._on_pick = on_pick
        self._handle: viser.BatchedMeshHandle | None = None
        self._ids: tuple[int, ...] = ()

    def draw(self, model: SceneModel, colouring: Colouring, *, visible: bool) -> None:
        """Show the nodes of a model."""
        count = len(model.ids)
        self._ids = tuple(model.ids.tolist())
        if not count:
            return
        positions = model.positions.astype(np.float32)
        scales = np.full(count, _RADIUS * model.step, dtype=np.float32)
        colors = node_colors(model, colouring)
        if self._handle is None:
            self._handle = self._add(positions, scales, colors)
        else:
            self._handle.batched_wxyzs = _upright(count)
            self._handle.batched_positions = positions
            self._handle.batched_scales = scales
            self._handle.batched_colors = colors
        self._handle.visible = visible

    def _add(self, positions: np.ndarray, scales: np.ndarray, colors: palette.Colors) -> viser.BatchedMeshHandle:
        handle = self._server.scene.add_batched_meshes_simple(
            "/graph/nodes",
            *sphere(),
            batched_wxyzs=_upright(len(positions)),
            batched_positions=positions,
            batched_scales=scales,
            batched_colors=colors,
            cast_shadow=False,
            receive_shadow=False,
            lod="off",
        )
        handle.on_click(self._clicked)
        return handle

    def _clicked(self, event: viser.SceneNodePointerEvent[viser.BatchedMeshHandle]) -> None:
        if event.instance_index is not None and event.instance_index < len(self._ids):
            self._on_pick(self._ids[event.instance_index])


def node_colors(model: SceneModel, colouring: Colouring) -> palette.Colors:
    """Colours (N, 3) of the nodes."""
    if colouring == "session":
        return palette.by_session(model.map_ids)
    if colouring == "time":
        return palette.by_value(model.stamps)
    if colouring == "weight":
        return palette.by_value(np.log1p(np.maximum(model.weights, 0).astype(np.float64)))
    return np.array([palette.TIERS[tier] for tier in Tier], dtype=np.uint8)[model.tiers]


def _upright(count: int) -> np.ndarray:
    return np.tile(np.array([1, 0, 0, 0], dtype=np.float32), (count, 1))
