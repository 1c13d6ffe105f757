"""Frames without images: made-up places with the word statistics of real ones, on a path of any length.

Of the words of a real node (hololens_tour, toyroom) five in six are new, three in four are seen by one node only and
one in five by two; so here a place shares a sixth of its landmarks with the one before, one in ten looks like things
that are found everywhere, and a visit sees most of its place's landmarks, each with a few bits other than last time.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.database import MapWriter
from slam.geometry import Pose, inverse, make, so3_exp, transform
from slam.params import Params
from slam.slam import Slam
from slam.types import UNKNOWN_VARIANCE, Features, Frame, Odometry, Update

CAMERA = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
_LANDMARKS = 600
_SHARED = 100
_SEEN = 500
#: Landmarks of a place that look like one of so many things, the k-th of them 1 / k times as often as the first.
_COMMON, _THINGS = 60, 1500
_STEP_M = 0.5
_FLIPPED_BITS = 6
_SIGMA_M, _SIGMA_RAD = 0.004, 0.001
_IMAGE = np.full((48, 64, 3), 90, np.uint8)
_DEPTH = np.zeros((480, 640), np.float32)


class GhostWorld:
    """A closed street of ``places``, walked again and again; frame k stands at place k modulo ``places``."""

    def __init__(self, places: int, *, seed: int = 0) -> None:
        self.places = places
        self._seed = seed
        self._things = np.random.default_rng([seed, 3]).integers(0, 256, (_THINGS, 32)).astype(np.uint8)
        self._often = (1.0 / np.arange(1, _THINGS + 1)) / (1.0 / np.arange(1, _THINGS + 1)).sum()

    def T_world_base(self, k: int) -> Pose:
        """True pose of a frame: on a circle, a hand's breadth beside where it was the lap before."""
        turn = 2 * np.pi * (k % self.places) / self.places
        radius = self.places * _STEP_M / (2 * np.pi) + 0.05 * (k // self.places % 3)
        R = so3_exp(np.array([0.0, 0.0, turn + np.pi / 2]))
        return make(R, np.array([radius * np.cos(turn), radius * np.sin(turn), 0.0]))

    def frames(self, count: int) -> Iterator[Frame]:
        """Frames with true poses, two a second, whose images show nothing."""
        for k in range(count):
            yield Frame(k, 0.5 * k, _IMAGE, _DEPTH, CAMERA, self.T_world_base(k))

    def features(self, k: int) -> Features:
        """What frame k sees."""
        rng = np.random.default_rng([self._seed, 1, k])
        points, descriptors = self._landmarks(k % self.places)
        rows = np.sort(rng.permutation(len(points))[:_SEEN])
        points_cam = transform(inverse(self.T_world_base(k) @ CAMERA.T_base_cam), points[rows])
        pixels = CAMERA.project(points_cam).astype(np.float32)
        flips = np.zeros((len(rows), 256), np.uint8)
        flips[np.arange(len(rows))[:, None], rng.integers(0, 256, (len(rows), _FLIPPED_BITS))] = 1
        zeros = np.zeros(len(rows), np.float32)
        return Features(
            pixels=pixels + rng.normal(0, 0.3, pixels.shape).astype(np.float32),
            sizes=zeros + 31,
            angles=zeros - 1,
            responses=zeros + 1,
            octaves=np.zeros(len(rows), np.int32),
            descriptors=descriptors[rows] ^ np.packbits(flips, axis=1),
            points_base=transform(CAMERA.T_base_cam, points_cam).astype(np.float32),
        )

    def _landmarks(self, place: int) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        own, before = self._own(place), self._own((place - 1) % self.places)
        return (
            np.concatenate([own[0][_SHARED:], before[0][:_SHARED]]),
            np.concatenate([own[1][_SHARED:], before[1][:_SHARED]]),
        )

    def _own(self, place: int) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        rng = np.random.default_rng([self._seed, 2, place])
        points_base = rng.uniform([2.0, -1.0, -0.8], [5.0, 1.0, 0.8], (_LANDMARKS, 3))
        looks = rng.integers(0, 256, (_LANDMARKS, 32)).astype(np.uint8)
        looks[-_COMMON:] = self._things[rng.choice(_THINGS, _COMMON, replace=False, p=self._often)]
        return transform(self.T_world_base(place), points_base), looks


class GhostOdometry:
    """Odometry that drifts as a real one does, over a ghost world."""

    def __init__(self, world: GhostWorld) -> None:
        self._world = world
        self._rng = np.random.default_rng(0)
        self._T_odom_base: Pose = np.eye(4)
        self._prepared: tuple[int, Features] | None = None

    def prepare(self, frame: Frame, params: Params) -> None:
        """Makes up what the frame sees ahead of its turn."""
        del params
        self._prepared = frame.index, self._world.features(frame.index)

    def track(self, frame: Frame, params: Params) -> Odometry:
        """The pose that odometry would give; the first frame starts the chain."""
        del params
        covariance = np.eye(6) * UNKNOWN_VARIANCE
        if frame.index:
            T = inverse(self._world.T_world_base(frame.index - 1)) @ self._world.T_world_base(frame.index)
            noise = make(so3_exp(self._rng.normal(0, _SIGMA_RAD, 3)), self._rng.normal(0, _SIGMA_M, 3))
            self._T_odom_base = self._T_odom_base @ T @ noise
            covariance = np.diag([_SIGMA_M**2] * 3 + [_SIGMA_RAD**2] * 3)
        index, features = self._prepared or (-1, None)
        if features is None or index != frame.index:
            features = self._world.features(frame.index)
        return Odometry(self._T_odom_base, covariance, features, len(features), len(features), False, None, 0.0)


class TrueOdometry(GhostOdometry):
    """Odometry without drift, wherever the robot goes."""

    def __init__(self, world: GhostWorld, first: int) -> None:
        super().__init__(world)
        self._T_odom_world = inverse(world.T_world_base(first))
        self._started = False

    def begin(self) -> None:
        """Odometry begins anew with the next frame."""
        self._started = False

    def track(self, frame: Frame, params: Params) -> Odometry:
        """The true pose, counted from the first frame."""
        odometry = super().track(replace(frame, index=frame.index + 1), params)
        covariance = np.eye(6) * (1e-6 if self._started else UNKNOWN_VARIANCE)
        self._started = True
        T_odom_base = self._T_odom_world @ self._world.T_world_base(frame.index)
        return replace(
            odometry, T_odom_base=T_odom_base, features=self._world.features(frame.index), covariance=covariance
        )


def visited(
    places: Sequence[int], params: Params, writer: MapWriter | None = None, *, begins: Collection[int] = ()
) -> tuple[Slam, list[Update]]:
    """An engine that saw these of 50 places, two a second, with true odometry that begins anew before some frames."""
    world = GhostWorld(50)
    frames = list(world.frames(50))
    slam, odometry = Slam(params, writer), TrueOdometry(world, places[0])
    slam._odometry = odometry  # type: ignore[assignment]
    updates = []
    for k, place in enumerate(places):
        if k in begins:
            odometry.begin()
        updates.append(slam.process(replace(frames[place], stamp=0.5 * k)))
    return slam, updates
