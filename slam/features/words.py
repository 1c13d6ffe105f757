"""Which key points of a node become words: odometry's, or others of their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slam.camera import Camera
from slam.features.extract import Extractor
from slam.features.region import Region
from slam.geometry import inverse, transform
from slam.params import Params
from slam.types import Features, Frame


class NodeFeatures:
    """The key points of a node, those that become words first."""

    def __init__(self) -> None:
        self._extractor = Extractor("Kp")

    def of(self, frame: Frame, odometry: Features, params: Params) -> tuple[Features, int]:
        """Features of a frame that becomes a node, and how many of them, from the first, become words.

        Odometry's are taken when ``Mem/UseOdomFeatures`` is on and ``Kp/DetectorStrategy`` is ``Vis/FeatureType``;
        words of another type are extracted for themselves, and nodes are then registered by those. A replayed frame may
        bring those that it had.
        """
        stored = frame.stored
        if stored is not None and stored.features is not None:
            return stored.features, stored.words
        shared = params.Mem.UseOdomFeatures and params.Kp.DetectorStrategy == params.Vis.FeatureType
        features = odometry if shared else self._extractor.extract(frame, params)
        chosen = _chosen(features, frame.camera, params)
        if (chosen == np.arange(len(chosen))).all():
            return features, len(chosen)
        rest = np.setdiff1d(np.arange(len(features)), chosen)
        return features.take(np.concatenate([chosen, rest])), len(chosen)


def _chosen(features: Features, camera: Camera, params: Params) -> NDArray[np.int64]:
    """Rows of the best ``Kp/MaxFeatures`` in the region and the range of depth, an equal share for each cell."""
    region = Region.of((camera.height, camera.width), params.Kp)
    good = region.inside(features.pixels)
    if params.Kp.MinDepth > 0 or params.Kp.MaxDepth > 0:
        depths = transform(inverse(camera.T_base_cam), features.points_base)[:, 2]
        good &= (depths > params.Kp.MinDepth) & (depths <= (params.Kp.MaxDepth or np.inf))
    return region.share(np.flatnonzero(good), features.pixels, params.Kp.MaxFeatures)


def nothing_seen() -> Features:
    """No key points."""
    return Features(
        pixels=np.zeros((0, 2), np.float32),
        sizes=np.zeros(0, np.float32),
        angles=np.zeros(0, np.float32),
        responses=np.zeros(0, np.float32),
        octaves=np.zeros(0, np.int32),
        descriptors=np.zeros((0, 32), np.uint8),
        points_base=np.zeros((0, 3), np.float32),
    )
