"""A transform from points that a person picked in two images or clouds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.edit.wishes import PickedPair
from slam.errors import DecisionError
from slam.geometry import Array, Pose, hat, make, normalized, transform
from slam.registration.rigid import fit

#: A hand on a picture and a depth camera are no better than this, metres.
_FLOOR_M = 0.01
#: Points whose spread across their longest line is smaller don't fix the turn about it, metres.
_LEAST_SPREAD_M = 0.03
#: Half the side of the square, in pixels of the depth image, in which depth is looked for.
_REACH = 2


class DepthReader(Protocol):
    """What picked points ask of a map file."""

    def cameras(self, node_id: int) -> tuple[Camera, ...]:
        """All cameras of a node, whose image has one tile for each."""
        ...

    def depth_m(self, node_id: int) -> NDArray[np.float32]:
        """The depth image (H, W) in metres, 0 where unknown."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """``T_from_to`` with its information (6, 6), and how far each pair is off, metres (N,)."""

    T_from_to: Pose
    information: Array
    residuals_m: Array


def fitted(points_from: Array, points_to: Array) -> Fitted:
    """The rigid motion that takes points (N, 3) of one base frame nearest to those of the other (Umeyama 1991).

    The information is that of the points, each as uncertain as the residuals say and at least by 1 cm.

    Raises:
        DecisionError: fewer than three pairs, or points that lie on one line.
    """
    if len(points_from) < 3:
        raise DecisionError(f"{len(points_from)} point pairs: at least 3 are needed, not on one line")
    for points in (points_from, points_to):
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[1]
        if spread < _LEAST_SPREAD_M:
            raise DecisionError(
                f"the points lie on one line (spread {spread:.3f} m across it, less than {_LEAST_SPREAD_M:g} m):"
                " pick one beside it"
            )
    T = normalized(make(*fit(np.ascontiguousarray(points_from), np.ascontiguousarray(points_to))))
    residuals = np.linalg.norm(points_from - transform(T, points_to), axis=1)
    variance = max(_FLOOR_M**2, float((residuals**2).sum()) / max(1, 3 * len(residuals) - 6))
    J = np.array([np.hstack([np.eye(3), -hat(point)]) for point in points_to])
    return Fitted(T, np.einsum("nki,nkj->ij", J, J) / variance, residuals)


def lifted(reader: DepthReader, from_id: int, to_id: int, pairs: Sequence[PickedPair]) -> tuple[Array, Array]:
    """Points (N, 3) of what was picked in the base frame of each node, metres.

    Raises:
        DecisionError: a pixel is outside its image, or no depth is known there.
        DatabaseError: a node in whose image something was picked has no depth image or no camera.
    """
    one, other = _Node(reader, from_id), _Node(reader, to_id)
    points = [(one.point(number, a), other.point(number, b)) for number, (a, b) in enumerate(pairs, 1)]
    both = np.array(points, np.float64).reshape(-1, 2, 3)
    return both[:, 0], both[:, 1]


class _Node:
    """A node in which points were picked; its images are read when one of them is needed."""

    def __init__(self, reader: DepthReader, node_id: int) -> None:
        self._reader = reader
        self._id = node_id

    @cached_property
    def _cameras(self) -> tuple[Camera, ...]:
        return self._reader.cameras(self._id)

    @cached_property
    def _depth_m(self) -> NDArray[np.float32]:
        return self._reader.depth_m(self._id)

    def point(self, number: int, picked: Sequence[float]) -> Array:
        """Point (3,) in the base frame: as it was picked in the cloud, or seen in a pixel."""
        if len(picked) == 3:
            return np.array(picked, np.float64)
        x, y = picked
        cameras, depth_m = self._cameras, self._depth_m
        width, height = sum(camera.width for camera in cameras), cameras[0].height
        if not (0 <= x < width and 0 <= y < height):
            raise DecisionError(
                f"pair {number}: ({x:g}, {y:g}) is outside the image of node {self._id}, {width}x{height}"
            )
        z = _depth_at(depth_m, (x + 0.5) * depth_m.shape[1] / width, (y + 0.5) * depth_m.shape[0] / height)
        if z is None:
            raise DecisionError(f"pair {number}: node {self._id} has no depth at ({x:g}, {y:g}): pick another point")
        left = 0
        for camera in cameras:
            if x < left + camera.width:
                break
            left += camera.width
        pixel = np.array([[x - left, y]])
        return np.asarray(transform(camera.T_base_cam, camera.unproject(pixel, np.array([z])))[0])


def _depth_at(depth_m: NDArray[np.float32], x: float, y: float) -> float | None:
    """Depth at a pixel; where it is not known, that of the nearest pixels around it (median)."""
    column, row = min(int(x), depth_m.shape[1] - 1), min(int(y), depth_m.shape[0] - 1)
    if depth_m[row, column] > 0:
        return float(depth_m[row, column])
    near = depth_m[max(0, row - _REACH) : row + _REACH + 1, max(0, column - _REACH) : column + _REACH + 1]
    known = near[near > 0]
    return float(np.median(known)) if len(known) else None
