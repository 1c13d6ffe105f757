"""Where to look from so that the whole map is in sight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from server.scene.placed import PlacedGraph
from slam.geometry import Pose
from slam.maps.local_grid import yaw

Array = NDArray[np.float64]

#: Vertical field of view, radians.
FIELD_OF_VIEW = np.radians(45.0)
#: Width by height that the view is made to fit: panes are wider than high.
_ASPECT = 1.25
_ELEVATION = np.radians(42.0)
#: What a node is taken to see, until its points are known.
_SIGHT_M = 2.0
#: What is shown at least, and of a map that is still growing.
_LEAST_SPAN_M = 2.0
_GROWING_SPAN_M = 9.0
_MARGIN = 1.14
#: From where a single node is looked at.
_BEHIND_M, _ABOVE_M = 1.6, 1.1


@dataclass(frozen=True, slots=True, eq=False)
class Framing:
    """A camera's place and the point it looks at, both (3,) metres in the map frame."""

    position: Array
    look_at: Array

    @property
    def distance(self) -> float:
        """From the camera to what it looks at, metres."""
        return float(np.linalg.norm(self.position - self.look_at))

    def differs(self, other: Framing) -> bool:
        """Whether the other shows something noticeably different."""
        moved = max(
            float(np.linalg.norm(self.position - other.position)), float(np.linalg.norm(self.look_at - other.look_at))
        )
        return moved > 0.05 * self.distance


def frame(graph: PlacedGraph, points: Array, *, growing: bool = False) -> Framing:
    """A three-quarter view from above of the nodes and of points (M, 3) that they saw; there must be a node.

    A map that is ``growing`` gets room: the camera won't follow it.
    """
    seen = _content(graph, points, _GROWING_SPAN_M if growing else _LEAST_SPAN_M)
    azimuth = _azimuth(graph, seen)
    forward = np.array(
        [np.cos(azimuth) * np.cos(_ELEVATION), np.sin(azimuth) * np.cos(_ELEVATION), -np.sin(_ELEVATION)]
    )
    right = np.array([np.sin(azimuth), -np.cos(azimuth), 0.0])
    up = np.cross(right, forward)
    tangent = np.tan(0.5 * FIELD_OF_VIEW) / _MARGIN
    x, y, z = seen @ right, seen @ up, seen @ forward
    # Each side of the view is a plane through the camera with all content inside of it: the camera's place across is
    # midway between the planes of two sides, and it steps back until both pairs of sides fit.
    place, depth = [], np.inf
    for across, slope in ((x, tangent * _ASPECT), (y, tangent)):
        low, high = float((across - slope * z).max()), float((across + slope * z).min())
        place.append(0.5 * (low + high))
        depth = min(depth, (high - low) / (2.0 * slope))
    camera = place[0] * right + place[1] * up + depth * forward
    return Framing(camera, camera + (float(np.median(z)) - depth) * forward)


def beside(T_map_base: Pose) -> Framing:
    """From behind and above a node along its heading: its own view from nearly its own place."""
    heading = yaw(T_map_base)
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    place = T_map_base[:3, 3]
    return Framing(place - _BEHIND_M * ahead + np.array([0.0, 0.0, _ABOVE_M]), place + _SIGHT_M * ahead)


def _content(graph: PlacedGraph, points: Array, least: float) -> Array:
    """What is to be in sight (K, 3): the path, what was seen from it without stray points, and a room of least size."""
    positions = graph.positions
    if len(points) >= 50:
        low, high = np.percentile(points, [2, 98], axis=0)
        low, high = np.minimum(low, positions.min(axis=0)), np.maximum(high, positions.max(axis=0))
        seen = points[((points >= low) & (points <= high)).all(axis=1)]
    else:
        seen = positions + _SIGHT_M * graph.T_map[:, :3, 0] if _is_indoor(positions) else positions
    content = np.concatenate([positions, seen])
    middle = 0.5 * (content.min(axis=0) + content.max(axis=0))
    reach = 0.5 * least
    room = middle + np.array([(a * reach, b * reach, 0.0) for a in (-1, 1) for b in (-1, 1)])
    return np.concatenate([content, room])


def _is_indoor(positions: Array) -> bool:
    """Whether two metres of sight matter on a path like this."""
    return float(np.ptp(positions[:, :2], axis=0).max()) < 50.0


def _azimuth(graph: PlacedGraph, seen: Array) -> float:
    """Direction of the view on the floor, radians: across the longer side, or along with a camera that never turned."""
    heading = graph.T_map[:, :2, 0].mean(axis=0)
    spread = seen[:, :2] - seen[:, :2].mean(axis=0)
    values, axes = np.linalg.eigh(spread.T @ spread)
    if np.linalg.norm(heading) > 0.6 or values[1] < 1.3 * values[0]:
        return float(np.arctan2(heading[1], heading[0]) + np.radians(20.0))
    across = axes[:, 0] if axes[:, 0] @ heading >= 0 else -axes[:, 0]
    return float(np.arctan2(across[1], across[0]) + np.radians(15.0))
