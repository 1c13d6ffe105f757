"""The path as odometry alone saw it, and the true one."""

from __future__ import annotations

import numpy as np
import viser

from server.scene import palette
from server.scene.model import Array, SceneModel
from server.scene.shapes import dashes, segments
from slam.evaluate import align
from slam.geometry import inverse

_PIXELS = 2.0


class PathLayer:
    """Draws both paths, session by session; each has one handle."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._handles: dict[str, viser.LineSegmentsHandle] = {}

    def draw(self, model: SceneModel, *, odometry: bool, truth: bool) -> None:
        """Show the paths of a model."""
        # Dashed, so that it is told from the optimised path where both run side by side.
        self._show("odometry", odometry_segments(model) if odometry else None, palette.ODOMETRY)
        self._show("truth", truth_segments(model) if truth else None, palette.TRUTH)

    def _show(self, name: str, points: Array | None, color: palette.Rgb) -> None:
        handle = self._handles.get(name)
        if points is None or not len(points):
            if handle is not None:
                handle.visible = False
            return
        drawn = points.astype(np.float32)
        if handle is None:
            handle = self._handles[name] = self._server.scene.add_line_segments(
                f"/paths/{name}", drawn, color, thickness=_PIXELS, thickness_units="screen"
            )
        else:
            handle.points = drawn
        handle.visible = True


def odometry_segments(model: SceneModel) -> Array:
    """Dashes along odometry's path; each session is laid where its first node is in the map."""
    parts = [np.zeros((0, 2, 3))]
    for rows in _sessions(model):
        rows = rows[np.isfinite(model.T_odom_base[rows, 0, 3])]
        if len(rows) < 2:
            continue
        T_map_odom = model.T_map_base[rows[0]] @ inverse(model.T_odom_base[rows[0]])
        positions = (T_map_odom @ model.T_odom_base[rows])[:, :3, 3]
        parts.append(dashes(positions, 0.5 * model.step))
    return np.concatenate(parts)


def truth_segments(model: SceneModel) -> Array:
    """The true path, laid on the map as the trajectory error sees it: by the best rigid motion over all nodes."""
    known = np.isfinite(model.T_world_base[:, 0, 3])
    if known.sum() < 3:
        return np.zeros((0, 2, 3))
    world = model.T_world_base[known][:, :3, 3]
    T_map_world = align(model.positions[known], world)
    return segments(world @ T_map_world[:3, :3].T + T_map_world[:3, 3])


def _sessions(model: SceneModel) -> list[np.ndarray]:
    return [np.flatnonzero(model.map_ids == map_id) for map_id in np.unique(model.map_ids)]
